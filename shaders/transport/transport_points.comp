#version 460
#extension GL_GOOGLE_include_directive : require
#include "transport/random.glsl"
#include "transport/transport_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// Draws the points: of each half about `wanted` in all, and of each tet as many as it weighs, or one more by chance.
struct TransportPointsPush {
  Vec2s weights;
  Floats total;
  Uints drawn;  // one: how many there are
  TransportPoints points;
  uint tet_count;
  uint seed;
  float wanted;
  uint room;  // points that there is room for
};
layout(push_constant, scalar) uniform Block { TransportPointsPush push; };

void main() {
  uint tet = gl_GlobalInvocationID.x;
  if (tet >= push.tet_count) return;
  vec2 weight = push.weights.at[tet];
  if (weight.x <= 0.0) return;
  float expected = push.wanted * weight.x / push.total.at[0];
  uint state = hash(tet ^ hash(push.seed));
  for (uint half_of = 0u; half_of < TRANSPORT_HALVES; ++half_of) {
    uint count = uint(expected + uniform_number(state));
    for (uint k = 0u; k < count; ++k) {
      uint at = atomicAdd(push.drawn.at[0], 1u);
      uint seed = hash(state + k);
      if (at < push.room) push.points.at[at] = TransportPoint(tet, seed, half_of, weight.y / expected);
    }
  }
}
