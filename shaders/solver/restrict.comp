#version 460
#extension GL_GOOGLE_include_directive : require
#include "solver/solve_shared.h"
#include "solver/fields.glsl"
#include "shared/stride.glsl"

// f_i = sum of weight_k r_(row_k), k from offset[i] to offset[i + 1]: the transpose of a transfer.
struct RestrictPush {
  Uints offset;
  TransposedEntries entry;
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
      TransposedEntry entry = push.entry.at[k];
      sum = add_scaled(sum, vec3(entry.weight), push.r.at[entry.row]);
    }
    push.f.at[i] = sum;
  }
}
