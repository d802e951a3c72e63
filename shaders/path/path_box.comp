#version 460
#extension GL_GOOGLE_include_directive : require
#include "path/path_shared.h"
#include "shared/stride.glsl"

// The box around vertices, as numbers that order as the coordinates do (sortable_float).
struct PathBoxPush {
  Vec3s vertices;  // mm
  Uints box;       // 6: low, high; begun at the largest and smallest number
  uint count;
};
layout(push_constant, scalar) uniform Block { PathBoxPush push; };

shared uint low[3], high[3];

// A number that is larger for a larger x.
uint sortable_float(float x) {
  uint bits = floatBitsToUint(x);
  return (bits & 0x80000000u) != 0u ? ~bits : bits | 0x80000000u;
}

void main() {
  for (uint k = gl_LocalInvocationID.x; k < 3u; k += WORKGROUP_SIZE) {
    low[k] = 0xffffffffu;
    high[k] = 0u;
  }
  barrier();
  EACH(i, push.count) {
    vec3 position = push.vertices.at[i];
    for (uint k = 0u; k < 3u; ++k) {
      atomicMin(low[k], sortable_float(position[k]));
      atomicMax(high[k], sortable_float(position[k]));
    }
  }
  barrier();
  for (uint k = gl_LocalInvocationID.x; k < 3u; k += WORKGROUP_SIZE) {
    atomicMin(push.box.at[k], low[k]);
    atomicMax(push.box.at[3u + k], high[k]);
  }
}
