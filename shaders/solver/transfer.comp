#version 460
#extension GL_GOOGLE_include_directive : require
#include "solver/solve_shared.h"
#include "solver/fields.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { TransferPush push; };

void main() {
  uint row = gl_GlobalInvocationID.x;
  if (row >= push.count) return;
  Field value = no_field();
  for (uint k = 0u; k < push.width; ++k) {
    uint j = push.coarse_first + load_row_uint(push.index, row * push.width + k);
    vec3 factor = load_row_float(push.weight, row * push.width + k) * load_vec3_or_one(push.coarse_to_phi, j);
    value = add_scaled(value, factor, load_field(push.coarse_x, j));
  }
  uint i = push.first + row;
  vec3 factor = mix(vec3(0), 1.0 / load_vec3_or_one(push.to_phi, i), greaterThan(push.state.at[0].norm, vec3(0)));
  push.x.at[i] = scaled(factor, value);
}
