#version 460
#extension GL_GOOGLE_include_directive : require
#include "assembly_shared.h"
#include "optics.h"
#include "fields.glsl"
#include "reduce.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
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
  uint i = gl_GlobalInvocationID.x;
  vec3 square = vec3(0);
  if (i < push.count) {
    Field b = diffuse_source(push.boundary, i < push.tet_count ? vec3(0) : surface_load(i - push.tet_count));
    push.b.at[i] = b;
    square = product(b, solved(push.diagonal.at[i], b));
  }
  vec3 norm;
  if (!reduce_dispatch(push.reduction, square, norm)) return;
  if (gl_LocalInvocationID.x == 0u) push.state.at[0].norm = norm;
}
