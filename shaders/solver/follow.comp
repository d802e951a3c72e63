#version 460
#extension GL_GOOGLE_include_directive : require
#include "solver/solve_shared.h"
#include "solver/fields.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { FollowPush push; };

Field change_of_coarse(uint row) {
  Field value = no_field();
  for (uint k = 0u; k < push.width; ++k) {
    uint j = push.coarse_first + load_row_uint(push.index, row * push.width + k);
    vec3 factor = load_row_float(push.weight, row * push.width + k) * load_vec3_or_one(push.coarse_to_phi, j);
    value = add_scaled(value, factor, difference(load_field(push.coarse_x, j), load_field(push.coarse_before, j)));
  }
  return scaled(1.0 / load_vec3_or_one(push.to_phi, push.first + row), value);
}

void main() {
  uint row = gl_GlobalInvocationID.x;
  if (row >= push.count) return;
  uint i = push.first + row;
  Field x = scaled(load_vec3(push.unit, 0) * load_scale(push.scale).inverse, load_field(push.x, i));
  if (push.keep_before == 1u) push.before.at[i] = x;
  if (push.has_coarse == 1u) x = add(x, change_of_coarse(row));
  push.x.at[i] = x;
}
