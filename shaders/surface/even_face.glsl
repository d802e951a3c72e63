// What is made even of the exitance of a face. The shader that includes it has an EvenPush as push.even.
#ifndef QUADGRAPH_EVEN_FACE_GLSL
#define QUADGRAPH_EVEN_FACE_GLSL

#include "surface/near_return.h"
#include "surface/surface_shared.h"

struct EvenFace {
  vec3 far;    // W/mm^2, exitance but for light that comes out near where it went in
  vec3 share;  // of it that is made even
  float area;  // mm^2
  uint lit;    // 1: light enters, 0: none does
};

EvenFace even_face(EvenRef even, uint face) {
  uvec3 ids = even.faces.at[face];
  vec3 p = even.vertices.at[ids.x];
  vec3 ab = even.vertices.at[ids.y] - p, ac = even.vertices.at[ids.z] - p, bc = ac - ab;
  Optical optical = even.optical.at[even.even == 1u ? 0u : even.face_tets.at[face]];
  vec3 exitance = even.exitance.at[face];
  vec3 q = even.q.at[face];
  vec3 near = min(NEAR_SHARE * half_space_return(optical, even.kept) * q, exitance);
  float edge = sqrt((dot(ab, ab) + dot(ac, ac) + dot(bc, bc)) / 3.0);
  return EvenFace(exitance - near, evened_share(optical, edge), 0.5 * length(cross(ab, ac)), q == vec3(0) ? 0u : 1u);
}

#endif
