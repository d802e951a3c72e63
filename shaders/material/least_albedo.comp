#version 460
#extension GL_GOOGLE_include_directive : require
#include "material/optics.h"
#include "shared/stride.glsl"

// The least albedo of coefficients, of all channels.
struct LeastAlbedoPush {
  Opticals optical;
  Uints least;  // 1: bits of the float, which order as the numbers do; begun at those of 1
  uint count;
};
layout(push_constant, scalar) uniform Block { LeastAlbedoPush push; };

shared uint least;

void main() {
  if (gl_LocalInvocationID.x == 0u) least = floatBitsToUint(1.0);
  barrier();
  EACH(i, push.count) {
    Optical o = push.optical.at[i];
    for (int c = 0; c < 3; ++c) {
      float both = o.sigma_s_prime[c] + o.sigma_a[c];
      atomicMin(least, floatBitsToUint(both > 0.0 ? o.sigma_s_prime[c] / both : 0.0));
    }
  }
  barrier();
  if (gl_LocalInvocationID.x == 0u) atomicMin(push.least.at[0], least);
}
