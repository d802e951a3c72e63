#ifndef QUADGRAPH_FACE_AREA_GLSL
#define QUADGRAPH_FACE_AREA_GLSL

#include "shared/shared.h"

// mm^2.
float area_of(Uvec3s faces, Vec3s vertices, uint face) {
  uvec3 corners = load_uvec3(faces, face);
  vec3 p = load_vec3(vertices, corners.x);
  return 0.5 * length(cross(load_vec3(vertices, corners.y) - p, load_vec3(vertices, corners.z) - p));
}

#endif
