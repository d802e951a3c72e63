#version 460
#extension GL_GOOGLE_include_directive : require
#include "assemble/assembly_shared.h"
#include "material/optics.h"
#include "solver/right_hand_side.glsl"

// Scaled b at every node, and its norm.
struct RightHandSideFdmPush {
  Vec3s nodes;
  Opticals optical;
  Uints face_tets;
  Uints face_kinds;
  Vec3s q;
  Scales scale;
  RightHandSideRef side;
  uint count;
  uint tet_count;
  Boundary boundary;
};
layout(push_constant, scalar) uniform Block { RightHandSideFdmPush push; };

// kappa_k q / (kappa_s d) at surface node `face`.
vec3 surface_load(uint face) {
  if (push.face_kinds.at[face] != FACE_OPEN) return vec3(0);
  uint tet = push.face_tets.at[face];
  float d = distance(push.nodes.at[tet], push.nodes.at[push.tet_count + face]);
  vec3 kappa_ratio = kappa(push.optical.at[tet]) / kappa(push.optical.at[push.tet_count + face]);
  return kappa_ratio * push.q.at[face] * push.scale.at[0].inverse / d;
}

void main() {
  vec3 square = vec3(0);
  EACH(i, push.count) {
    vec3 load = i < push.tet_count ? vec3(0) : surface_load(i - push.tet_count);
    square += store_b(push.side, i, diffuse_source(push.boundary, load));
  }
  store_norm(push.side, square);
}
