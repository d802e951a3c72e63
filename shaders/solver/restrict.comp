#version 460
#extension GL_GOOGLE_include_directive : require
#include "solver/solve_shared.h"
#include "solver/fields.glsl"
#include "shared/stride.glsl"

// f_i = sum of weight_p r_(p / BARYCENTRIC_WIDTH), p = place_k, k from offset[i] to offset[i + 1]: the
// transpose of the transfer whose weights these are.
struct RestrictPush {
  Uints offset;
  Uints place;
  Floats weight;
  Fields r;
  Fields f;
  uint count;
};
layout(push_constant, scalar) uniform Block { RestrictPush push; };

void main() {
  EACH(i, push.count) {
    Field sum = no_field();
    uint end = push.offset.at[i + 1u];
    for (uint k = push.offset.at[i]; k < end; ++k) {
      uint place = push.place.at[k];
      sum = add_scaled(sum, vec3(push.weight.at[place]), push.r.at[place / BARYCENTRIC_WIDTH]);
    }
    push.f.at[i] = sum;
  }
}
