#version 460
#extension GL_GOOGLE_include_directive : require
#include "solve_shared.h"
#include "fields.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { CgDirectionPush push; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  Field direction;
  if (push.multigrid == 1u) {
    direction = push.z.at[i];
  } else {
    direction = solved(push.diagonal.at[i], push.r.at[i]);
  }
  // The old direction of the first iteration is no number one may count on.
  vec3 beta = push.state.at[0].beta;
  if (beta != vec3(0)) direction = add_scaled(direction, beta, push.p.at[i]);
  push.p.at[i] = direction;
}
