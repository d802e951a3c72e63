#version 460
#extension GL_GOOGLE_include_directive : require
#include "material/optics.h"
#include "shared/stride.glsl"

// The least albedo of coefficients, of all channels, and how far their channels lie apart in an operator's entries.
struct OpticalRangePush {
  Opticals optical;
  Uints range;  // 2: bits of floats, which order as the numbers do; begun at those of 1
  float spacing;
  uint count;
};
layout(push_constant, scalar) uniform Block { OpticalRangePush push; };

shared uint least;
shared uint most;

void main() {
  if (gl_LocalInvocationID.x == 0u) least = most = floatBitsToUint(1.0);
  barrier();
  EACH(i, push.count) {
    Optical o = push.optical.at[i];
    for (int c = 0; c < 3; ++c) {
      float both = o.sigma_s_prime[c] + o.sigma_a[c];
      atomicMin(least, floatBitsToUint(both > 0.0 ? o.sigma_s_prime[c] / both : 0.0));
    }
    atomicMax(most, floatBitsToUint(entry_contrast(o, push.spacing)));
  }
  barrier();
  if (gl_LocalInvocationID.x == 0u) {
    atomicMin(push.range.at[0], least);
    atomicMax(push.range.at[1], most);
  }
}
