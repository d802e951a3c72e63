#version 460
#extension GL_GOOGLE_include_directive : require
#include "solve_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { CgDirectionPush push; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  push.p.at[i] = push.r.at[i] / push.diagonal.at[i] + push.state.at[0].beta * push.p.at[i];
}
