#version 460
#extension GL_GOOGLE_include_directive : require
#include "solve_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { TransferPush push; };

void main() {
  uint row = gl_GlobalInvocationID.x;
  if (row >= push.count) return;
  vec3 phi = vec3(0);
  for (uint k = 0u; k < push.width; ++k) {
    uint j = push.coarse_first + push.index.at[row * push.width + k];
    phi += push.weight.at[row * push.width + k] * push.coarse_to_phi.at[j] * push.coarse_x.at[j];
  }
  uint i = push.first + row;
  push.x.at[i] = mix(vec3(0), phi / push.to_phi.at[i], greaterThan(push.state.at[0].norm, vec3(0)));
}
