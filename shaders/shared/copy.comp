#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// target[i] = source[i], invocation k those of k, k + invocations, ...
struct CopyPush {
  Uvec4s source;
  Uvec4s target;
  uint count;
  uint invocations;  // in the dispatch, a multiple of WORKGROUP_SIZE
};
layout(push_constant, scalar) uniform Block { CopyPush push; };

void main() {
  for (uint i = gl_GlobalInvocationID.x; i < push.count; i += push.invocations) push.target.at[i] = push.source.at[i];
}
