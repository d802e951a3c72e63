#version 460
#extension GL_GOOGLE_include_directive : require
#include "material/optics.h"
#include "shared/stride.glsl"

// The least albedo of coefficients, of all channels, and how much packed entries round.
struct OpticalRangePush {
  Opticals optical;
  Uints range;  // 3: albedo, packed_rounding; bits of floats, which order as the numbers do; begun at those of 1
  float spacing;
  uint count;
};
layout(push_constant, scalar) uniform Block { OpticalRangePush push; };

shared uint least;
shared uint most[2];

void main() {
  if (gl_LocalInvocationID.x == 0u) least = most[0] = most[1] = floatBitsToUint(1.0);
  barrier();
  EACH(i, push.count) {
    Optical o = push.optical.at[i];
    for (int c = 0; c < 3; ++c) {
      float both = o.sigma_s_prime[c] + o.sigma_a[c];
      atomicMin(least, floatBitsToUint(both > 0.0 ? o.sigma_s_prime[c] / both : 0.0));
    }
    vec2 rounding = packed_rounding(o, push.spacing);
    atomicMax(most[0], floatBitsToUint(rounding.x));
    atomicMax(most[1], floatBitsToUint(rounding.y));
  }
  barrier();
  if (gl_LocalInvocationID.x == 0u) {
    atomicMin(push.range.at[0], least);
    atomicMax(push.range.at[1], most[0]);
    atomicMax(push.range.at[2], most[1]);
  }
}
