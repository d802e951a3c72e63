#version 460
#extension GL_GOOGLE_include_directive : require
#include "solver/solve_shared.h"
#include "solver/fields.glsl"
#include "shared/stride.glsl"

// x += transfer of the coarse x.
struct ProlongPush {
  Uints index;
  Floats weight;
  Fields coarse_x;
  Fields x;
  uint count;
};
layout(push_constant, scalar) uniform Block { ProlongPush push; };

void main() {
  EACH(i, push.count) {
    Field x = push.x.at[i];
    for (uint k = BARYCENTRIC_WIDTH * i; k < BARYCENTRIC_WIDTH * (i + 1u); ++k) {
      x = add_scaled(x, vec3(push.weight.at[k]), push.coarse_x.at[push.index.at[k]]);
    }
    push.x.at[i] = x;
  }
}
