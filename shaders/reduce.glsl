// Reduction over a whole dispatch in a fixed order, so that results repeat bit for bit: every workgroup stores a
// partial, the last one to finish combines them. Include after defining REDUCE(a, b) and the identity REDUCE_ZERO for
// anything but sums. All functions must be called by every invocation.
#ifndef REDUCE
#define REDUCE(a, b) ((a) + (b))
#define REDUCE_ZERO vec3(0)
#endif

#extension GL_EXT_control_flow_attributes : require

shared vec3 reduce_scratch[WORKGROUP_SIZE];
shared bool reduce_last;

// Result in invocation 0. Two rounds of 16 need fewer barriers than a binary tree. Loops stay loops: unrolled, every
// invocation of lavapipe would walk through all of the body with nothing to do, and compile it for a second.
vec3 reduce_workgroup(vec3 value) {
  uint lane = gl_LocalInvocationID.x;
  reduce_scratch[lane] = value;
  barrier();
  if (lane < 16u) {
    vec3 part = value;
    [[dont_unroll]] for (uint k = lane + 16u; k < WORKGROUP_SIZE; k += 16u) part = REDUCE(part, reduce_scratch[k]);
    reduce_scratch[lane] = part;
  }
  barrier();
  vec3 total = REDUCE_ZERO;
  if (lane == 0u) {
    [[dont_unroll]] for (uint k = 0u; k < 16u; ++k) total = REDUCE(total, reduce_scratch[k]);
  }
  barrier();
  return total;
}

// True in the workgroup that finishes last; `total` then holds the result in invocation 0.
bool reduce_dispatch(Reduction reduction, vec3 value, out vec3 total) {
  uint lane = gl_LocalInvocationID.x;
  vec3 partial = reduce_workgroup(value);
  if (lane == 0u) {
    reduction.partials[gl_WorkGroupID.x] = partial;
    memoryBarrierBuffer();
    reduce_last = atomicAdd(reduction.ticket, 1u) == gl_NumWorkGroups.x - 1u;
  }
  barrier();
  total = REDUCE_ZERO;
  if (!reduce_last) return false;
  memoryBarrierBuffer();
  vec3 mine = REDUCE_ZERO;
  for (uint k = lane; k < gl_NumWorkGroups.x; k += WORKGROUP_SIZE) mine = REDUCE(mine, reduction.partials[k]);
  total = reduce_workgroup(mine);
  if (lane == 0u) reduction.ticket = 0u;
  return true;
}

// The same for two sums at once.
bool reduce_dispatch_pair(Reduction reduction, vec3 a, vec3 b, out vec3 total_a, out vec3 total_b) {
  uint lane = gl_LocalInvocationID.x;
  vec3 partial_a = reduce_workgroup(a), partial_b = reduce_workgroup(b);
  if (lane == 0u) {
    reduction.partials[2u * gl_WorkGroupID.x] = partial_a;
    reduction.partials[2u * gl_WorkGroupID.x + 1u] = partial_b;
    memoryBarrierBuffer();
    reduce_last = atomicAdd(reduction.ticket, 1u) == gl_NumWorkGroups.x - 1u;
  }
  barrier();
  total_a = total_b = REDUCE_ZERO;
  if (!reduce_last) return false;
  memoryBarrierBuffer();
  vec3 mine_a = REDUCE_ZERO, mine_b = REDUCE_ZERO;
  for (uint k = lane; k < gl_NumWorkGroups.x; k += WORKGROUP_SIZE) {
    mine_a = REDUCE(mine_a, reduction.partials[2u * k]);
    mine_b = REDUCE(mine_b, reduction.partials[2u * k + 1u]);
  }
  total_a = reduce_workgroup(mine_a);
  total_b = reduce_workgroup(mine_b);
  if (lane == 0u) reduction.ticket = 0u;
  return true;
}
