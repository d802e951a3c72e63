// Shortest paths and voxels of what is given as arrays, for tests and scripts.
#pragma once

#include <span>
#include <vector>

#include "engine/base/path_options.h"
#include "engine/path/voxels.h"

namespace quadgraph {

// Lengths by PathRelaxation through `size` cells, multiples of PATH_BLOCK, of side `cell`, mm. Three channels, one
// after the other, x fastest: cost, 1/mm, below 0 where a cell is not solid in any channel; and light that enters,
// W/mm^2, 0 where none does. Throws InputError on a wrong size.
std::vector<float> paths_through(device::Device& device, const glm::uvec3& size, float cell,
                                 std::span<const float> cost, std::span<const float> entering, PathSolver solver);

// What Voxels makes of a mesh.
struct GivenVoxels {
  gpu::PathGrid grid{};
  std::vector<std::uint32_t> flags;  // CELL_*, x fastest
};
GivenVoxels voxels_of(device::Device& device, std::span<const glm::vec3> vertices,
                      std::span<const glm::uvec3> triangles, std::uint32_t cells);

}  // namespace quadgraph
