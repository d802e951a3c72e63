#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/forward_scattering.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// Coefficients as rays see them: of light that scatters beside the forward peak.
struct TransportOpticalPush {
  Opticals optical;
  Opticals beside;  // written
  vec3 g;
  uint count;
};
layout(push_constant, scalar) uniform Block { TransportOpticalPush push; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  Optical optical = push.optical.at[i];
  push.beside.at[i] = Optical(beside_peak(push.g) * optical.sigma_s_prime, optical.sigma_a);
}
