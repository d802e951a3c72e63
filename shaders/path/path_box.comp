#version 460
#extension GL_GOOGLE_include_directive : require
#include "path/path_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { PathBoxPush push; };

shared uint low[3], high[3];

// A number that is larger for a larger x.
uint sortable_float(float x) {
  uint bits = floatBitsToUint(x);
  return (bits & 0x80000000u) != 0u ? ~bits : bits | 0x80000000u;
}

void main() {
  uint lane = gl_LocalInvocationID.x, i = gl_GlobalInvocationID.x;
  if (lane < 3u) {
    low[lane] = 0xffffffffu;
    high[lane] = 0u;
  }
  barrier();
  if (i < push.count) {
    vec3 position = load_vec3(push.vertices, i);
    for (uint k = 0u; k < 3u; ++k) {
      atomicMin(low[k], sortable_float(position[k]));
      atomicMax(high[k], sortable_float(position[k]));
    }
  }
  barrier();
  if (lane < 3u) {
    atomicMin(push.box.at[lane], low[lane]);
    atomicMax(push.box.at[3u + lane], high[lane]);
  }
}
