#version 460
#extension GL_GOOGLE_include_directive : require
#include "gather/gather_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { GatherSinglePush push; };

void main() {
  uint v = gl_GlobalInvocationID.x;
  if (v < push.count) push.scale.at[v] = GatherScale(vec3(1), load_vec3(push.exitance, v), vec3(0));
}
