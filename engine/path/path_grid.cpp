#include "engine/path/path_grid.h"

#include <algorithm>
#include <cmath>

namespace quadgraph {

gpu::PathGrid grid_around(const glm::vec3& low, const glm::vec3& high, std::uint32_t cells) {
  const glm::vec3 extent = high - low;
  const float longest = std::max({extent.x, extent.y, extent.z, 1e-20f});
  gpu::PathGrid grid{};
  grid.cell = longest / static_cast<float>(cells);
  for (int axis = 0; axis < 3; ++axis) {
    const auto wanted = static_cast<std::uint32_t>(std::ceil(extent[axis] / grid.cell)) + 2;
    grid.size[axis] = (wanted + PATH_BLOCK - 1) / PATH_BLOCK * PATH_BLOCK;
    grid.origin[axis] = 0.5f * (low[axis] + high[axis]) - 0.5f * grid.cell * static_cast<float>(grid.size[axis]);
  }
  return grid;
}

std::uint32_t block_count(const gpu::PathGrid& grid) {
  return gpu::cell_count(grid) / (PATH_BLOCK * PATH_BLOCK * PATH_BLOCK);
}

}  // namespace quadgraph
