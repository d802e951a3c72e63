#include "engine/path/voxels.h"

#include <algorithm>
#include <array>
#include <bit>

#include "engine/path/path_pass.h"
#include "interface/path/path_box.comp.h"
#include "interface/path/path_crossings.comp.h"
#include "interface/path/path_solid.comp.h"
#include "interface/path/path_winding.comp.h"

namespace quadgraph {
namespace {

// A single triangle may cover all columns: of few triangles several invocations take one.
constexpr std::uint32_t least_invocations = 8192;

// Undoes sortable_float of path_box.comp.
float from_sortable(std::uint32_t number) {
  return std::bit_cast<float>((number & 0x80000000u) != 0 ? number & 0x7fffffffu : ~number);
}

}  // namespace

Voxels::Voxels(device::Device& device)
    : device_(device),
      box_pass_(device, shader::path_box),
      crossings_pass_(device, shader::path_crossings),
      winding_pass_(device, shader::path_winding),
      solid_pass_(device, shader::path_solid),
      box_(device, 6 * sizeof(std::uint32_t), device::Place::device, "path/box"),
      counts_(device, sizeof(gpu::PathCounts), device::Place::device, "path/counts of cells") {}

std::uint32_t Voxels::stripes(const PathMesh& mesh) {
  return std::max(least_invocations / std::max(mesh.triangle_count, 1u), 1u);
}

void Voxels::fit(const PathMesh& mesh, std::uint32_t cells, std::vector<PassStats>& passes) {
  constexpr std::array<std::uint32_t, 6> none = {~0u, ~0u, ~0u, 0, 0, 0};
  run_pass(device_, "box", mesh.vertices.size(), passes, [&](device::Commands& commands) {
    commands.update(box_, std::as_bytes(std::span(none)));
    commands.dispatch(box_pass_, gpu::PathBoxPush{mesh.vertices.address(), box_.address(), mesh.vertex_count},
                      mesh.vertex_count);
  });
  const auto found = device::download<std::uint32_t>(device_, box_);
  glm::vec3 low, high;
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = from_sortable(found[axis]);
    high[axis] = from_sortable(found[3 + axis]);
  }
  grid_ = grid_around(low, high, cells);
}

void Voxels::update(const PathMesh& mesh, std::uint32_t cells, const gpu::PathTools& tools,
                    std::vector<PassStats>& passes) {
  fit(mesh, cells, passes);
  const std::uint64_t count = gpu::cell_count(grid_), blocks = block_count(grid_), word = sizeof(std::uint32_t);
  make_room(device_, crossings_, 3 * count * word, device::Place::device, "path/crossings");
  make_room(device_, flags_, count * word, device::Place::device, "path/flags");
  make_room(device_, triangle_, count * word, device::Place::device, "path/triangles of cells");
  make_room(device_, wanted_, 6 * blocks * word, device::Place::device, "path/wanted");
  const std::uint32_t stripes = Voxels::stripes(mesh);
  const gpu::PathCrossingsPush crossings{grid_,
                                         mesh.vertices.address(),
                                         mesh.triangles.address(),
                                         crossings_.address(),
                                         flags_.address(),
                                         triangle_.address(),
                                         mesh.triangle_count,
                                         stripes,
                                         tools};
  const std::uint64_t bytes = mesh.triangles.size() + 36ull * mesh.triangle_count + 8 * 3 * count * word;
  run_pass(device_, "voxels", bytes, passes, [&](device::Commands& commands) {
    commands.fill(crossings_, 0);
    commands.fill(flags_, 0);
    commands.fill(triangle_, 0);
    commands.fill(wanted_, ~0u);
    commands.fill(counts_, 0);
    commands.dispatch(crossings_pass_, crossings, 3ull * stripes * mesh.triangle_count);
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      commands.dispatch(winding_pass_, gpu::PathWindingPush{grid_, crossings_.address() + axis * count * word, axis},
                        count / grid_.size[static_cast<int>(axis)]);
    }
    commands.dispatch(
        solid_pass_,
        gpu::PathSolidPush{grid_, crossings_.address(), flags_.address(), wanted_.address(), counts_.address(), tools},
        count);
  });
  solid_ = device::download<std::uint32_t>(device_, counts_)[0];
}

}  // namespace quadgraph
