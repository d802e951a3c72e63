#version 460
#extension GL_GOOGLE_include_directive : require
#include "solve_shared.h"
#include "fields.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { FollowPush push; };

Field change_of_coarse(uint row) {
  Field value = no_field();
  for (uint k = 0u; k < push.width; ++k) {
    uint j = push.coarse_first + push.index.at[row * push.width + k];
    vec3 factor = push.weight.at[row * push.width + k] * push.coarse_to_phi.at[j];
    value = add_scaled(value, factor, difference(push.coarse_x.at[j], push.coarse_before.at[j]));
  }
  return scaled(1.0 / push.to_phi.at[push.first + row], value);
}

void main() {
  uint row = gl_GlobalInvocationID.x;
  if (row >= push.count) return;
  uint i = push.first + row;
  Field x = scaled(push.unit.at[0] * push.scale.at[0].inverse, push.x.at[i]);
  if (push.keep_before == 1u) push.before.at[i] = x;
  if (push.has_coarse == 1u) x = add(x, change_of_coarse(row));
  push.x.at[i] = x;
}
