// EACH(i, count) { ... }: elements that an invocation takes, for dispatches of as many workgroups as the device is fast
// with (vk::Work::strided). On a GPU that is one; llvmpipe starts eight invocations for about what a row costs them.
// Gives the shader its workgroup size, which reduce.glsl takes to be WORKGROUP_SIZE unless it knows.
#ifndef QUADGRAPH_STRIDE_GLSL
#define QUADGRAPH_STRIDE_GLSL

#include "shared/part.glsl"
#include "shared/shared.h"

#ifdef GROUP_SIZE
#error "stride.glsl: reduce.glsl has taken another workgroup size"
#endif

layout(local_size_x = WORKGROUP_SIZE, local_size_x_id = 7) in;
#define GROUP_SIZE gl_WorkGroupSize.x
// The elements of a workgroup follow each other, so that what they read does: those below this of the one before it.
uint end_of_group(uint group, uint count) {
  uint all = gl_NumWorkGroups.x * GROUP_SIZE;
  return min((count + all - 1u) / all * GROUP_SIZE * (group + 1u), count);
}
uint first_of_group(uint group, uint count) {
  return group == 0u ? 0u : end_of_group(group - 1u, count);
}
#define EACH(i, count)                                                                                  \
  for (uint i = first_of_group(gl_WorkGroupID.x, count) + gl_LocalInvocationID.x,                       \
            end_##i = end_of_group(gl_WorkGroupID.x, count);                                            \
       PART != PART_CONCLUSION && i < end_##i; i += GROUP_SIZE)

#endif
