#version 460
#extension GL_GOOGLE_include_directive : require
#include "assembly_shared.h"
#define REDUCE(a, b) max(a, b)
#define REDUCE_ZERO vec3(0)
#include "reduce.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { DampingPush push; };

// Gershgorin's bound for one unknown per row; entries that are matrices are left to the other bound.
vec3 row_sum(uint i) {
#if MOMENTS == 1
  uint slice = i / SLICE_ROWS;
  uint end = push.rows.slice_offset.at[slice + 1u];
  vec3 diagonal = push.rows.diagonal.at[i].a11;
  vec3 sum = diagonal;
  for (uint e = push.rows.slice_offset.at[slice] + i % SLICE_ROWS; e < end; e += SLICE_ROWS) {
    sum += abs(push.rows.weight.at[e].a11);
  }
  return sum / diagonal;
#else
  return vec3(4);
#endif
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  vec3 largest;
  if (!reduce_dispatch(push.reduction, i < push.count ? row_sum(i) : vec3(0), largest)) return;
  if (gl_LocalInvocationID.x == 0u) push.damping.at[0] = 2.0 / min(vec3(4), largest);
}
