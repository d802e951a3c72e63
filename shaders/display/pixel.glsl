// A pixel of the picture and its 2 x 2 samples. With the push constants of the passes that make them.
#ifndef QUADGRAPH_PIXEL_GLSL
#define QUADGRAPH_PIXEL_GLSL

#include "light/render_shared.h"

layout(push_constant, scalar) uniform Block { ResolvePush push; };

struct Pixel {
  uint first;  // sample, the upper left one
  uint index;  // in the picture
};

// The pixel of this invocation; false where the tile has none.
bool find_pixel(out Pixel pixel) {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.tile_width * push.tile_height) return false;
  uint x = i % push.tile_width, y = i / push.tile_width;
  pixel = Pixel(2u * (y * push.sample_stride + x), (push.tile_y + y) * push.picture_width + push.tile_x + x);
  return true;
}

uint sample_of(Pixel pixel, uint k) {
  return pixel.first + (k & 1u) + (k >> 1u) * push.sample_stride;
}

void write_pixel(Pixel pixel, vec3 layers[PICTURE_LAYERS], float alpha) {
  for (uint layer = 0u; layer < PICTURE_LAYERS; ++layer) {
    for (uint c = 0u; c < 3u; ++c) push.layers[layer].at[3u * pixel.index + c] = layers[layer][c];
  }
  push.alpha.at[pixel.index] = alpha;
}

#endif
