#version 460
#extension GL_GOOGLE_include_directive : require
#include "render_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { ResolvePush push; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.tile_width * push.tile_height) return;
  uint x = i % push.tile_width, y = i / push.tile_width;
  uint s = 2u * y * push.sample_stride + 2u * x;
  uint below = s + push.sample_stride;
  uint pixel = (push.tile_y + y) * push.picture_width + push.tile_x + x;
  for (uint layer = 0u; layer < PICTURE_LAYERS; ++layer) {
    Vec4s samples = push.samples[layer];
    vec4 mean = 0.25 * (samples.at[s] + samples.at[s + 1u] + samples.at[below] + samples.at[below + 1u]);
    for (uint c = 0u; c < 3u; ++c) push.layers[layer].at[3u * pixel + c] = mean[c];
    if (layer == 0u) push.alpha.at[pixel] = mean.a;
  }
}
