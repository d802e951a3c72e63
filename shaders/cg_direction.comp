#version 460
#extension GL_GOOGLE_include_directive : require
#include "solve_shared.h"
#include "fields.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { CgDirectionPush push; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  Field z = solved(push.diagonal.at[i], push.r.at[i]);
  push.p.at[i] = add_scaled(z, push.state.at[0].beta, push.p.at[i]);
}
