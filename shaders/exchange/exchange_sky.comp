#version 460
#extension GL_GOOGLE_include_directive : require
#include "exchange/exchange_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// Share of the sky that each face of a level sees: of its `rays` those that met nothing, or from the next level that
// is known, as rows of weights say.
struct ExchangeSkyPush {
  Uvec2s rows;  // of ExchangeMatrix; null: as the next say
  Uints offset;
  Uints index;
  Floats weight;
  Floats from;
  Floats sky;  // written
  uint count;
  uint rays;
};
layout(push_constant, scalar) uniform Block { ExchangeSkyPush push; };

void main() {
  uint f = gl_GlobalInvocationID.x;
  if (f >= push.count) return;
  if (uvec2(push.rows) != uvec2(0)) {
    uvec2 row = push.rows.at[f];
    push.sky.at[f] = 1.0 - float(row.y - row.x) / float(push.rays);
    return;
  }
  uint begin = push.offset.at[f], end = push.offset.at[f + 1u];
  float sum = begin == end ? 1.0 : 0.0;
  for (uint k = begin; k < end; ++k) sum += push.weight.at[k] * push.from.at[push.index.at[k]];
  push.sky.at[f] = sum;
}
