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
  Boundaries boundaries;  // by body
  Vec3s q;
  Scales scale;
  RightHandSideRef side;
  uint count;
  uint tet_count;
};
layout(push_constant, scalar) uniform Block { RightHandSideFdmPush push; };

// kappa_k q / (kappa_s d) at surface node `face`.
vec3 surface_load(uint face) {
  if (!is_open(push.face_kinds, face)) return vec3(0);
  uint tet = push.face_tets.at[face];
  float d = distance(push.nodes.at[tet], push.nodes.at[push.tet_count + face]);
  vec3 kappa_ratio = kappa(push.optical.at[tet]) / kappa(push.optical.at[push.tet_count + face]);
  return kappa_ratio * push.q.at[face] * push.scale.at[0].inverse / d;
}

void main() {
  vec3 square = vec3(0);
  EACH(i, push.count) {
    vec3 load = vec3(0);
    uint body = 0u;
    if (i >= push.tet_count) {
      load = surface_load(i - push.tet_count);
      body = body_behind(push.face_kinds, i - push.tet_count);
    }
    square += store_b(push.side, i, diffuse_source(push.boundaries.at[body], load));
  }
  store_norm(push.side, square);
}
