#version 460
#extension GL_GOOGLE_include_directive : require
#include "solver/solve_shared.h"
#include "solver/fields.glsl"
#include "shared/stride.glsl"

layout(push_constant, scalar) uniform Block { ProlongPush push; };

void main() {
  EACH(i, push.count) {
    Field x = load_field(push.x, i);
    for (uint k = push.width * i; k < push.width * (i + 1u); ++k) {
      x = add_scaled(x, vec3(load_row_float(push.weight, k)), load_field(push.coarse_x, load_row_uint(push.index, k)));
    }
    push.x.at[i] = x;
  }
}
