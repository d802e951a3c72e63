#version 460
#extension GL_GOOGLE_include_directive : require
#include "light/render_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// Marks the pixels of a tile that the silhouette may cross: those near samples that differ in whether they show
// anything.
struct SilhouettePush {
  Uints seen;    // per sample: 1 + the display triangle, 0: none
  Uints marked;  // bits by pixels in a row, of silhouette_words(width) to a row; added to
  TilePixels tile;
  uint before;  // pixels to the left of two samples that differ, or above them, that are marked too
  uint after;   // to the right of the left one, or below the upper one
};
layout(push_constant, scalar) uniform Block { SilhouettePush push; };

bool covered(uint x, uint y) {
  return push.seen.at[y * push.tile.sample_stride + x] != 0u;
}

// Whether samples of the pixel and those next to its right and below show something in part; also where those next to it
// are another tile's.
bool differs(uint x, uint y) {
  if (x == 0u && push.tile.left > 0u || y == 0u && push.tile.top > 0u) return true;
  if (x + 1u == push.tile.width && push.tile.left + x + 1u < push.tile.picture_width) return true;
  if (y + 1u == push.tile.height && push.tile.top + y + 1u < push.tile.picture_height) return true;
  uint right = min(2u * x + 2u, 2u * push.tile.width - 1u), below = min(2u * y + 2u, 2u * push.tile.height - 1u);
  bool first = covered(2u * x, 2u * y);
  for (uint j = 2u * y; j <= below; ++j) {
    for (uint i = 2u * x; i <= right; ++i) {
      if (covered(i, j) != first) return true;
    }
  }
  return false;
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.tile.width * push.tile.height) return;
  uint x = i % push.tile.width, y = i / push.tile.width;
  if (!differs(x, y)) return;
  uint words = silhouette_words(push.tile.width);
  uint last_x = min(x + push.after, push.tile.width - 1u), last_y = min(y + push.after, push.tile.height - 1u);
  for (uint row = y - min(y, push.before); row <= last_y; ++row) {
    for (uint column = x - min(x, push.before); column <= last_x; ++column) {
      atomicOr(push.marked.at[row * words + column / 32u], 1u << column % 32u);
    }
  }
}
