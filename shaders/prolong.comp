#version 460
#extension GL_GOOGLE_include_directive : require
#include "solve_shared.h"
#include "fields.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { ProlongPush push; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  Field x = push.x.at[i];
  for (uint k = push.width * i; k < push.width * (i + 1u); ++k) {
    x = add_scaled(x, vec3(push.weight.at[k]), push.coarse_x.at[push.index.at[k]]);
  }
  push.x.at[i] = x;
}
