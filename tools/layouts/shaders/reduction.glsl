// A sum over a whole dispatch in the way REDUCTION says.
#ifndef QUADGRAPH_LAYOUTS_REDUCTION_GLSL
#define QUADGRAPH_LAYOUTS_REDUCTION_GLSL

#include "layout.glsl"
#include "shared/reduce.glsl"

shared vec3 subgroup_sums[WORKGROUP_SIZE];

// Result in the first subgroup.
vec3 sum_workgroup(vec3 value) {
  vec3 part = subgroupAdd(value);
  if (subgroupElect()) subgroup_sums[gl_SubgroupID] = part;
  barrier();
  vec3 total = vec3(0);
  if (gl_SubgroupID == 0u) {
    for (uint k = gl_SubgroupInvocationID; k < gl_NumSubgroups; k += gl_SubgroupSize) total += subgroup_sums[k];
    total = subgroupAdd(total);
  }
  barrier();
  return total;
}

// True where `total` holds the result in invocation 0. With REDUCTION_DISPATCH that is nowhere: reduce_partials.comp
// adds up what the workgroups leave.
bool sum_dispatch(Reduction reduction, vec3 value, out vec3 total) {
#if REDUCTION == REDUCTION_TICKET
  return reduce_dispatch(reduction, value, total);
#else
  uint lane = gl_LocalInvocationID.x;
  vec3 partial = sum_workgroup(value);
  total = vec3(0);
  if (lane == 0u) reduction.partials[gl_WorkGroupID.x] = partial;
#if REDUCTION == REDUCTION_DISPATCH
  return false;
#else
  if (lane == 0u) {
    memoryBarrierBuffer();
    reduce_last = atomicAdd(reduction.ticket, 1u) == gl_NumWorkGroups.x - 1u;
  }
  barrier();
  if (!reduce_last) return false;
  memoryBarrierBuffer();
  vec3 mine = vec3(0);
  for (uint k = lane; k < gl_NumWorkGroups.x; k += WORKGROUP_SIZE) mine += reduction.partials[k];
  total = sum_workgroup(mine);
  if (lane == 0u) reduction.ticket = 0u;
  return true;
#endif
#endif
}

#endif
