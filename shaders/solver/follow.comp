#version 460
#extension GL_GOOGLE_include_directive : require
#include "solver/solve_shared.h"
#include "solver/fields.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// The last solution as the next start: before = x in the present units, x = before + transfer of what has
// changed on the coarser level since. `coarse_x` null: there is none. `before` null: no finer level will ask.
struct FollowPush {
  Uints index;
  Floats weight;
  Fields coarse_x;
  Fields coarse_before;
  Vec3s coarse_to_phi;
  Vec3s to_phi;
  Fields x;
  Fields before;
  Vec3s unit;  // one: the scale that x has
  Scales scale;
  uint width;
  uint first;
  uint coarse_first;
  uint count;
  uint has_coarse;
  uint keep_before;
};
layout(push_constant, scalar) uniform Block { FollowPush push; };

Field change_of_coarse(uint row) {
  Field value = no_field();
  for (uint k = 0u; k < push.width; ++k) {
    uint j = push.coarse_first + push.index.at[row * push.width + k];
    vec3 factor = push.weight.at[row * push.width + k] * element_or_one(push.coarse_to_phi, j);
    value = add_scaled(value, factor, difference(push.coarse_x.at[j], push.coarse_before.at[j]));
  }
  return scaled(1.0 / element_or_one(push.to_phi, push.first + row), value);
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
