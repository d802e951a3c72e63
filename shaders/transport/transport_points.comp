#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/beam_shared.h"
#include "transport/transport_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// Draws the points: of each half about `wanted` in all, of each tet as many as it weighs. Draw after draw a tet and a half
// have so many, to within one, and where each lies continues one sequence (transport_sweep.comp).
struct TransportPointsPush {
  Vec2s weights;
  Floats total;
  Uints drawn;  // one: how many there are
  TransportPoints points;
  uint tet_count;
  uint draw;  // 0, 1, ...
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
  for (uint half_of = 0u; half_of < TRANSPORT_HALVES; ++half_of) {
    // Tets that follow each other lie together: their golden turns keep what is rounded apart.
    float turn = float((tet * GOLDEN_TURN ^ half_of << 31u) >> 8u) * exp2(-24.0);
    uint begin = uint(float(push.draw) * expected + turn), end = uint(float(push.draw + 1u) * expected + turn);
    for (uint number = begin; number < end; ++number) {
      uint at = atomicAdd(push.drawn.at[0], 1u);
      if (at < push.room) push.points.at[at] = TransportPoint(tet, number, half_of, weight.y / expected);
    }
  }
}
