#version 460
#extension GL_GOOGLE_include_directive : require
#include "solve_shared.h"
#include "fields.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { RestrictPush push; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  Field sum = no_field();
  for (uint k = load_row_uint(push.offset, i); k < load_row_uint(push.offset, i + 1u); ++k) {
    uint place = load_row_uint(push.place, k);
    sum = add_scaled(sum, vec3(load_row_float(push.weight, place)), load_field(push.r, place / push.width));
  }
  push.f.at[i] = sum;
}
