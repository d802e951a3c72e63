#version 460
#extension GL_GOOGLE_include_directive : require
#include "display/display_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// Counts of the covered pixels of a picture, by luminance and by their brightest channel.
struct LuminancePush {
  Floats layers[PICTURE_LAYERS];  // RGB per pixel
  Floats alpha;                   // per pixel
  Uints bins;  // LUMINANCE_BINS twice, added to; what is below the first or black is in the first
  vec3 red;            // rows of the balance of white
  vec3 green;
  vec3 blue;
  uint count;          // pixels
};
layout(push_constant, scalar) uniform Block { LuminancePush push; };

float radiance(uint value) {
  return max(push.layers[0].at[value], 0.0) + push.layers[1].at[value] + push.layers[2].at[value];
}

// Into the bins from `first` on.
void count(uint first, float value) {
  float stop = value > 0.0 ? log2(value) : LEAST_STOP;
  float bin = clamp((stop - LEAST_STOP) * BINS_PER_STOP, 0.0, float(LUMINANCE_BINS - 1u));
  atomicAdd(push.bins.at[first + uint(bin)], 1u);
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count || push.alpha.at[i] != 1.0) return;
  vec3 sum = vec3(radiance(3u * i), radiance(3u * i + 1u), radiance(3u * i + 2u));
  vec3 seen = vec3(dot(push.red, sum), dot(push.green, sum), dot(push.blue, sum));
  count(0u, luminance(seen));
  count(LUMINANCE_BINS, max(max(seen.x, seen.y), seen.z));
}
