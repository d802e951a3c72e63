#version 460
#extension GL_GOOGLE_include_directive : require
#include "display_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { LuminancePush push; };

float radiance(uint value) {
  return max(push.layers[0].at[value], 0.0) + push.layers[1].at[value] + push.layers[2].at[value];
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count || push.alpha.at[i] != 1.0) return;
  // ITU-R BT.709.
  float luminance = 0.2126 * radiance(3u * i) + 0.7152 * radiance(3u * i + 1u) + 0.0722 * radiance(3u * i + 2u);
  float stop = luminance > 0.0 ? log2(luminance) : LEAST_STOP;
  float bin = clamp((stop - LEAST_STOP) * BINS_PER_STOP, 0.0, float(LUMINANCE_BINS - 1u));
  atomicAdd(push.bins.at[uint(bin)], 1u);
}
