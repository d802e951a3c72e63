#version 460
#extension GL_GOOGLE_include_directive : require
#include "solver/solve_shared.h"
#include "solver/fields.glsl"
#include "shared/stride.glsl"

layout(push_constant, scalar) uniform Block { RestrictPush push; };

void main() {
  EACH(i, push.count) {
    Field sum = no_field();
    uint end = load_row_uint(push.offset, i + 1u);
    for (uint k = load_row_uint(push.offset, i); k < end; ++k) {
      uint place = load_row_uint(push.place, k);
      sum = add_scaled(sum, vec3(load_row_float(push.weight, place)), load_field(push.r, place / BARYCENTRIC_WIDTH));
    }
    push.f.at[i] = sum;
  }
}
