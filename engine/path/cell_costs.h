// What a mm of path costs in the cells: the material where they lie in the body at rest.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "engine/base/path_options.h"
#include "engine/optics/edit.h"
#include "engine/optics/optical_grid.h"
#include "engine/path/voxels.h"

namespace quadgraph {

class CellCosts {
 public:
  explicit CellCosts(device::Device& device);

  // A material, or a grid of coefficients; nothing, for coefficients that only the nodes of levels have.
  void set(const gpu::Material& material);
  void set(const OpticalGrid& grid);
  void clear();

  // Edits of the material or the grid (engine/optics/edit.h); checked before.
  void set(std::span<const Edit> edits);

  // Evaluates the coefficients into `cost` (PathRelaxation::cost). `rest`: vertices of the mesh at rest, null where it
  // lies there. Throws InputError where nothing is set.
  void run(const Voxels& voxels, const PathMesh& mesh, const device::Buffer* rest, PathCost kind,
           const device::Buffer& cost, std::vector<PassStats>& passes);

 private:
  const device::Buffer& flood(const Voxels& voxels, std::vector<PassStats>& passes);

  device::Device& device_;
  device::ComputePass cost_pass_;
  std::optional<device::ComputePass> flood_pass_;  // made at first use
  std::optional<gpu::Material> material_;
  gpu::PathMaterial grid_{};  // its part of it
  device::Buffer optical_, edits_, points_, texels_;
  std::uint32_t edit_count_ = 0;
  bool wants_depth_ = false;   // of the edits
  device::Buffer body_;        // gpu::PathMaterial
  device::Buffer nearest_[2];  // PathFloodPush
};

}  // namespace quadgraph
