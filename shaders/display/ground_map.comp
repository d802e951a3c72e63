#version 460
#extension GL_GOOGLE_include_directive : require
#include "display/ground_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// How dark every texel of the ground is, from the depth of the body seen from below.
struct GroundMapPush {
  Floats depth;   // GROUND_SIZE^2, 0 on the ground to 1 at `far`
  Floats shadow;  // the same, share of the light that is missing; written
  float far;              // mm
  float reach;            // mm above the ground from which a surface still darkens it by 1/e
};
layout(push_constant, scalar) uniform Block { GroundMapPush push; };

// Light that is missing under what hangs over a texel; nothing beyond the map does.
float missing(ivec2 texel) {
  if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, ivec2(GROUND_SIZE)))) return 0.0;
  float depth = push.depth.at[texel.y * GROUND_SIZE + texel.x];
  return depth >= 1.0 ? 0.0 : exp(-depth * push.far / push.reach);
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= GROUND_SIZE * GROUND_SIZE) return;
  ivec2 texel = ivec2(i % GROUND_SIZE, i / GROUND_SIZE);
  float sum = 0.0, weights = 0.0;
  for (int y = -GROUND_SPREAD; y <= GROUND_SPREAD; ++y) {
    for (int x = -GROUND_SPREAD; x <= GROUND_SPREAD; ++x) {
      float weight = exp(-3.0 * float(x * x + y * y) / float(GROUND_SPREAD * GROUND_SPREAD));
      sum += weight * missing(texel + ivec2(x, y));
      weights += weight;
    }
  }
  push.shadow.at[i] = GROUND_STRENGTH * sum / weights;
}
