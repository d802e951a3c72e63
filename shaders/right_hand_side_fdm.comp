#version 460
#extension GL_GOOGLE_include_directive : require
#include "optics.h"
#include "reduce.glsl"
#include "solve_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block {
  RightHandSideFdmPush push;
};

// kappa_k Q / (2 A kappa_s d) at surface node `face`.
vec3 surface_value(uint face) {
  uint tet = push.face_tets.at[face];
  float d = distance(push.nodes.at[tet], push.nodes.at[push.tet_count + face]);
  vec3 kappa_ratio = kappa(push.optical.at[tet]) / kappa(push.optical.at[push.tet_count + face]);
  vec3 q = push.q.at[face] * push.scale.at[0].inverse;
  return kappa_ratio * q * (push.source / (2.0 * push.mismatch * d));
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  vec3 square = vec3(0);
  if (i < push.count) {
    vec3 b = i < push.tet_count ? vec3(0) : surface_value(i - push.tet_count);
    push.b.at[i] = b;
    square = b * b / push.diagonal.at[i];
  }
  vec3 norm;
  if (!reduce_dispatch(push.reduction, square, norm)) return;
  if (gl_LocalInvocationID.x == 0u) push.state.at[0].norm = norm;
}
