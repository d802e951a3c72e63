#include "engine/path/given_cells.h"

#include <string>

#include "engine/base/error.h"
#include "engine/path/path_relaxation.h"

namespace quadgraph {

std::vector<float> paths_through(device::Device& device, const glm::uvec3& size, float cell,
                                 std::span<const float> cost, std::span<const float> entering, PathSolver solver) {
  gpu::PathGrid grid{};
  grid.cell = cell;
  grid.size = size;
  const std::size_t count = gpu::cell_count(grid);
  for (int axis = 0; axis < 3; ++axis) {
    if (size[axis] % PATH_BLOCK != 0 || size[axis] < PATH_BLOCK || size[axis] > gpu::LARGEST_PATH_CELLS) {
      throw InputError("cells: found " + std::to_string(size[axis]) + " along a side, expected a multiple of " +
                       std::to_string(PATH_BLOCK) + " up to " + std::to_string(gpu::LARGEST_PATH_CELLS));
    }
  }
  if (cost.size() != 3 * count || entering.size() != 3 * count) {
    throw InputError("cells: " + std::to_string(cost.size()) + " costs and " + std::to_string(entering.size()) +
                     " lights, expected " + std::to_string(3 * count) + " each");
  }
  std::vector<std::uint32_t> flags(count);
  for (std::size_t i = 0; i < count; ++i) flags[i] = cost[i] >= 0 ? gpu::CELL_SOLID : 0;
  const std::vector<std::uint32_t> wanted(6 * block_count(grid), 0);
  const device::Buffer flag_buffer = device::upload<std::uint32_t>(device, flags, "path/flags");
  const device::Buffer wanted_buffer = device::upload<std::uint32_t>(device, wanted, "path/wanted");
  PathRelaxation relaxation(device);
  relaxation.make_room(grid);
  device::write_bytes(device, relaxation.cost(), std::as_bytes(cost));
  device::write_bytes(device, relaxation.entering(), std::as_bytes(entering));
  std::vector<PassStats> passes;
  relaxation.solve({grid, flag_buffer, wanted_buffer}, solver, passes);
  std::vector<float> lengths = device::download<float>(device, relaxation.lengths());
  lengths.resize(3 * count);
  return lengths;
}

GivenVoxels voxels_of(device::Device& device, std::span<const glm::vec3> vertices,
                      std::span<const glm::uvec3> triangles, std::uint32_t cells) {
  const device::Buffer vertex_buffer = device::upload(device, vertices, "path/vertices");
  const device::Buffer triangle_buffer = device::upload(device, triangles, "path/triangles");
  Voxels voxels(device);
  std::vector<PassStats> passes;
  voxels.update({vertex_buffer, triangle_buffer, static_cast<std::uint32_t>(vertices.size()),
                 static_cast<std::uint32_t>(triangles.size())},
                cells, {}, passes);
  return {voxels.grid(), device::download<std::uint32_t>(device, voxels.cells().flags)};
}

}  // namespace quadgraph
