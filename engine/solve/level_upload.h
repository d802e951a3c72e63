// A level of the file on the device.
#pragma once

#include <vector>

#include "engine/solve/simulation.h"

namespace quadgraph {

// Geometry of level `number`; optical is undefined, q zero.
LevelBuffers upload_level(vk::Context& context, const Level& level, std::uint32_t number);

// The transfers of one level that a method needs: phi at `count` unknowns from `first` on, from those of the coarser
// level from `coarse_first` on.
struct TransferBuffers {
  struct Part {
    vk::Buffer index, weight;
    std::uint32_t width = 0, first = 0, coarse_first = 0, count = 0;
  };
  std::vector<Part> parts;

  TransferBuffers(vk::Context& context, const Level& level, const Level& coarse, std::uint32_t number, Method method);
};

}  // namespace quadgraph
