// How much of the sky the faces of all levels see, on the device, from what is known on one of them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/solve/exchange_matrix.h"
#include "engine/solve/level_buffers.h"
#include "engine/solve/workspace.h"

namespace quadgraph {

class SkyLevels {
 public:
  // Of the levels of a body, the one with the matrix.
  SkyLevels(device::Device& device, std::span<const Level> levels, std::uint32_t known);

  // By the matrix, as sky_of_levels (engine/reference/sky.h) has it.
  void record(Workspace& work, const ExchangeMatrix& matrix, std::span<const LevelBuffers> levels) const;

 private:
  // The faces of a level as weighted sums of those of a neighbour's.
  struct Rows {
    device::Buffer offset, index, weight;
  };

  void record_from(Workspace& work, const Rows& rows, const LevelBuffers& from, const LevelBuffers& level) const;

  std::uint32_t known_;
  std::vector<std::optional<Rows>> rows_;  // by level; none of the known one
};

}  // namespace quadgraph
