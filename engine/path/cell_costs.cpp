#include "engine/path/cell_costs.h"

#include <algorithm>
#include <bit>

#include "engine/base/error.h"
#include "engine/path/path_pass.h"
#include "interface/path/path_cost.comp.h"
#include "interface/path/path_flood.comp.h"

namespace quadgraph {

CellCosts::CellCosts(device::Device& device)
    : device_(device),
      cost_pass_(device, shader::path_cost),
      body_(device, sizeof(gpu::PathMaterial), device::Place::device, "path/material") {}

void CellCosts::set(const gpu::Material& material) {
  clear();
  material_ = material;
}

void CellCosts::set(const OpticalGrid& grid) {
  clear();
  optical_ = device::upload(device_, grid.optical, "path/coefficients");
  grid_.optical = optical_.address();
  grid_.optical_size = grid.size;
  grid_.optical_spacing = grid.spacing;
  grid_.optical_first = grid.first;
}

void CellCosts::clear() {
  material_.reset();
  optical_ = {};
  grid_ = {};
}

void CellCosts::set(std::span<const Edit> edits) {
  const EditArrays arrays(edits);
  edit_count_ = static_cast<std::uint32_t>(arrays.edits.size());
  wants_depth_ = arrays.wants_depth();
  device::rewrite<gpu::MaterialEdit>(device_, arrays.edits, "path/edits", edits_);
  device::rewrite<glm::vec3>(device_, arrays.points, "path/strokes", points_);
  device::rewrite<glm::vec3>(device_, arrays.texels, "path/images", texels_);
}

const device::Buffer& CellCosts::flood(const Voxels& voxels, std::vector<PassStats>& passes) {
  const gpu::PathGrid& grid = voxels.grid();
  const std::uint64_t count = gpu::cell_count(grid);
  if (!flood_pass_) {
    flood_pass_.emplace(device_, shader::path_flood);
  }
  for (device::Buffer& nearest : nearest_) {
    make_room(device_, nearest, count * sizeof(std::uint32_t), device::Place::device, "path/nearest");
  }
  const std::uint32_t longest = std::max({grid.size.x, grid.size.y, grid.size.z});
  std::uint32_t last = 0;
  run_pass(device_, "nearest surface", 0, passes, [&](device::Commands& commands) {
    const auto record = [&](std::uint32_t step) {
      commands.dispatch(*flood_pass_,
                        gpu::PathFloodPush{grid, voxels.triangle().address(), nearest_[last].address(),
                                           nearest_[1 - last].address(), step},
                        count);
      last = 1 - last;
    };
    record(0);
    for (std::uint32_t step = std::bit_ceil(longest) / 2; step > 0; step /= 2) record(step);
    record(1);  // which makes up for most of what jumps miss
  });
  return nearest_[last];
}

void CellCosts::run(const Voxels& voxels, const PathMesh& mesh, const device::Buffer* rest, PathCost kind,
                    const device::Buffer& cost, std::vector<PassStats>& passes) {
  if (!material_ && optical_.size() == 0) {
    throw InputError(
        "shortest-path: coefficients are given per node of levels, which it does not know; give a material or a "
        "volume");
  }
  gpu::PathMaterial body = grid_;
  if (material_) body.material = *material_;
  body.edits = edits_.address();
  body.points = points_.address();
  body.texels = texels_.address();
  body.edit_count = edit_count_;
  body.cost = kind == PathCost::extinction ? gpu::COST_EXTINCTION : gpu::COST_TRANSPORT;
  device::write_bytes(device_, body_, std::as_bytes(std::span(&body, 1)));
  const bool placed = !material_ || material_->pattern != gpu::PATTERN_NONE || edit_count_ > 0;
  const bool deep = (material_ && material_->pattern == gpu::PATTERN_LAYERS) || wants_depth_;
  const device::Buffer* nearest = (placed && rest != nullptr) || deep ? &flood(voxels, passes) : nullptr;
  const gpu::PathCostPush push{voxels.grid(),
                               voxels.cells().flags.address(),
                               nearest ? nearest->address() : 0,
                               voxels.triangle().address(),
                               mesh.triangles.address(),
                               mesh.vertices.address(),
                               rest ? rest->address() : mesh.vertices.address(),
                               body_.address(),
                               cost.address()};
  const std::uint64_t count = gpu::cell_count(voxels.grid());
  run_pass(device_, "path cost", 16 * count, passes,
           [&](device::Commands& commands) { commands.dispatch(cost_pass_, push, count); });
}

}  // namespace quadgraph
