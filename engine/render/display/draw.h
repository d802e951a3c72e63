// Recording of a draw into images.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/vk/commands.h"

namespace quadgraph {

// A rectangle of the target, pixels; it may begin outside, so that a tile shows a part of a larger picture.
struct Viewport {
  float x = 0, y = 0, width = 0, height = 0;
};

struct DrawTarget {
  std::vector<const vk::Image*> colours;
  const vk::Image* depth = nullptr;
  std::uint32_t width = 0, height = 0;  // of the upper left part that is cleared and drawn into, pixels; 0: all
};

// Clears the images (colour 0, depth 1; contents before are dropped), draws an indexed triangle list with y up, and
// leaves the images in TRANSFER_SRC_OPTIMAL. `indices` holds `index_count` u32.
void draw_bytes(vk::Commands& commands, const DrawTarget& target, const Viewport& viewport,
                const vk::GraphicsPass& pass, const void* push, std::uint32_t push_size, const vk::Buffer& indices,
                std::uint32_t index_count);

template <typename Push>
void draw(vk::Commands& commands, const DrawTarget& target, const Viewport& viewport, const vk::GraphicsPass& pass,
          const Push& push, const vk::Buffer& indices, std::uint32_t index_count) {
  draw_bytes(commands, target, viewport, pass, &push, sizeof(Push), indices, index_count);
}

}  // namespace quadgraph
