// A pixel of the picture and its 2 x 2 samples. The shader that includes it has push constants `push` with the `tile`,
// `layers` and `alpha` of ResolvePush.
#ifndef QUADGRAPH_PIXEL_GLSL
#define QUADGRAPH_PIXEL_GLSL

#include "light/render_shared.h"

struct Pixel {
  uint first;    // sample, the upper left one
  uint index;    // in the picture
  uvec2 inside;  // column and row in the tile
};

// The pixel of this invocation; false where the tile has none.
bool find_pixel(out Pixel pixel) {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.tile.width * push.tile.height) return false;
  uint x = i % push.tile.width, y = i / push.tile.width;
  pixel.first = 2u * (y * push.tile.sample_stride + x);
  pixel.index = (push.tile.top + y) * push.tile.picture_width + push.tile.left + x;
  pixel.inside = uvec2(x, y);
  return true;
}

uint sample_of(Pixel pixel, uint k) {
  return pixel.first + (k & 1u) + (k >> 1u) * push.tile.sample_stride;
}

void write_pixel(Pixel pixel, vec3 layers[PICTURE_LAYERS], float alpha) {
  for (uint layer = 0u; layer < PICTURE_LAYERS; ++layer) {
    for (uint c = 0u; c < 3u; ++c) push.layers[layer].at[3u * pixel.index + c] = layers[layer][c];
  }
  push.alpha.at[pixel.index] = alpha;
}

#endif
