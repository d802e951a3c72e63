#ifndef QUADGRAPH_FACE_AREA_GLSL
#define QUADGRAPH_FACE_AREA_GLSL

#include "shared/shared.h"

// mm^2.
float area_of(Uvec3s faces, Vec3s vertices, uint face) {
  uvec3 corners = faces.at[face];
  vec3 p = vertices.at[corners.x];
  return 0.5 * length(cross(vertices.at[corners.y] - p, vertices.at[corners.z] - p));
}

#endif
