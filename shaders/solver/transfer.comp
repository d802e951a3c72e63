#version 460
#extension GL_GOOGLE_include_directive : require
#include "solver/solve_shared.h"
#include "solver/fields.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// x = sum of weight * to_phi_coarse * x_coarse / to_phi (1 where null), for `count` rows from `first`
// on; 0 in a channel without light.
struct TransferPush {
  Uints index;
  Floats weight;
  Fields coarse_x;
  Vec3s coarse_to_phi;
  Vec3s to_phi;
  Fields x;
  SolveStates state;
  uint width;
  uint first;
  uint coarse_first;  // added to every index
  uint count;
};
layout(push_constant, scalar) uniform Block { TransferPush push; };

void main() {
  uint row = gl_GlobalInvocationID.x;
  if (row >= push.count) return;
  Field value = no_field();
  for (uint k = 0u; k < push.width; ++k) {
    uint j = push.coarse_first + push.index.at[row * push.width + k];
    vec3 factor = push.weight.at[row * push.width + k] * element_or_one(push.coarse_to_phi, j);
    value = add_scaled(value, factor, push.coarse_x.at[j]);
  }
  uint i = push.first + row;
  vec3 factor = mix(vec3(0), 1.0 / element_or_one(push.to_phi, i), greaterThan(push.state.at[0].norm, vec3(0)));
  push.x.at[i] = scaled(factor, value);
}
