// Reduction over a whole dispatch in a fixed order, so that results repeat bit for bit: every workgroup stores a
// partial, the last one to finish combines them. A shader that wants anything but sums defines REDUCE(a, b) and its
// identity REDUCE_ZERO first. All functions must be called by every invocation.
#ifndef QUADGRAPH_REDUCE_GLSL
#define QUADGRAPH_REDUCE_GLSL

#include "shared/shared.h"

#ifndef REDUCE
#define REDUCE(a, b) ((a) + (b))
#define REDUCE_ZERO vec3(0)
#endif

shared vec3 reduce_scratch[WORKGROUP_SIZE];
shared bool reduce_last;

// Result in invocation 0. Two rounds of 16 need fewer barriers than a binary tree.
vec3 reduce_workgroup(vec3 value) {
  uint lane = gl_LocalInvocationID.x, first = min(16u, WORKGROUP_SIZE);
  reduce_scratch[lane] = value;
  barrier();
  if (WORKGROUP_SIZE > 16u) {
    if (lane < 16u) {
      vec3 part = value;
      for (uint k = lane + 16u; k < WORKGROUP_SIZE; k += 16u) part = REDUCE(part, reduce_scratch[k]);
      reduce_scratch[lane] = part;
    }
    barrier();
  }
  vec3 total = REDUCE_ZERO;
  if (lane == 0u) {
    for (uint k = 0u; k < first; ++k) total = REDUCE(total, reduce_scratch[k]);
  }
  barrier();
  return total;
}

// Keeps the workgroup's partial number `k`, of `each`. True after the last, in the workgroup that combines them.
bool reduce_keep(Reduction reduction, vec3 partial, uint k, uint each) {
  if (gl_LocalInvocationID.x == 0u) reduction.partials[each * gl_WorkGroupID.x + k] = partial;
  if (k + 1u < each) return false;
  if (gl_LocalInvocationID.x == 0u) {
    memoryBarrierBuffer();
    reduce_last = atomicAdd(reduction.ticket, 1u) == gl_NumWorkGroups.x - 1u;
  }
  barrier();
  if (reduce_last) memoryBarrierBuffer();
  return reduce_last;
}

// All partials number `k`.
vec3 reduce_partials(Reduction reduction, uint k, uint each) {
  vec3 mine = REDUCE_ZERO;
  for (uint g = gl_LocalInvocationID.x; g < gl_NumWorkGroups.x; g += WORKGROUP_SIZE) {
    mine = REDUCE(mine, reduction.partials[each * g + k]);
  }
  return reduce_workgroup(mine);
}

// True in the workgroup that finishes last; `total` then holds the result in invocation 0.
bool reduce_dispatch(Reduction reduction, vec3 value, out vec3 total) {
  total = REDUCE_ZERO;
  if (!reduce_keep(reduction, reduce_workgroup(value), 0u, 1u)) return false;
  total = reduce_partials(reduction, 0u, 1u);
  if (gl_LocalInvocationID.x == 0u) reduction.ticket = 0u;
  return true;
}

// Reduces three sums in one dispatch.
bool reduce_dispatch_three(Reduction reduction, mat3 values, out mat3 totals) {
  totals = mat3(REDUCE_ZERO, REDUCE_ZERO, REDUCE_ZERO);
  bool last = false;
  for (uint k = 0u; k < 3u; ++k) last = reduce_keep(reduction, reduce_workgroup(values[k]), k, 3u);
  if (!last) return false;
  for (uint k = 0u; k < 3u; ++k) totals[k] = reduce_partials(reduction, k, 3u);
  if (gl_LocalInvocationID.x == 0u) reduction.ticket = 0u;
  return true;
}

// Reduces two sums in one dispatch.
bool reduce_dispatch_pair(Reduction reduction, vec3 a, vec3 b, out vec3 total_a, out vec3 total_b) {
  total_a = total_b = REDUCE_ZERO;
  reduce_keep(reduction, reduce_workgroup(a), 0u, 2u);
  if (!reduce_keep(reduction, reduce_workgroup(b), 1u, 2u)) return false;
  total_a = reduce_partials(reduction, 0u, 2u);
  total_b = reduce_partials(reduction, 1u, 2u);
  if (gl_LocalInvocationID.x == 0u) reduction.ticket = 0u;
  return true;
}

#endif
