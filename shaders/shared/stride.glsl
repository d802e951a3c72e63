// EACH(i, count) { ... }: the elements of a workgroup, of a dispatch with one invocation for each of `count` or more.
// Where one invocation does the work of a workgroup (tools/shader_headers/native.py) it takes them one after the other.
// Gives the shader its workgroup size.
#ifndef QUADGRAPH_STRIDE_GLSL
#define QUADGRAPH_STRIDE_GLSL

#include "shared/shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

#define EACH(i, count)                                                                                     \
  for (uint i = GROUP_ELEMENTS * gl_WorkGroupID.x + gl_LocalInvocationID.x,                                \
            end_##i = min(uint(count), GROUP_ELEMENTS * (gl_WorkGroupID.x + 1u));                          \
       i < end_##i; i += WORKGROUP_SIZE)

#endif
