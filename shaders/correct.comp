#version 460
#extension GL_GOOGLE_include_directive : require
#include "solve_shared.h"
#include "fields.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { CorrectPush push; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i == 0u) push.state.at[0].iterations += 1u;
  if (i < push.count) push.x.at[i] = add(load_field(push.x, i), load_field(push.z, i));
}
