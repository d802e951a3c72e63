// A closed, open or broken triangle mesh as solid cells, made anew on the device whenever it has changed.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/pass_stats.h"
#include "engine/device/memory.h"
#include "engine/device/pipeline.h"
#include "engine/path/path_grid.h"

namespace quadgraph {

// A triangle mesh on the device: vec3, mm, and uvec3.
struct PathMesh {
  const device::Buffer& vertices;
  const device::Buffer& triangles;
  std::uint32_t vertex_count = 0, triangle_count = 0;
};

// The nodes of the graph.
struct SolidCells {
  gpu::PathGrid grid;
  const device::Buffer& flags;   // uint per cell, CELL_*
  const device::Buffer& wanted;  // gpu::PathRelaxPush, of blocks that are not listed: 0, or that they never are
};

// A cell is solid where its middle is inside the surface or the surface crosses, within the cell, one of the three
// lines through its middle: so thin sheets are not lost. Inside is what more than three of the six directions along
// these lines say (shaders/path/path_shared.h): holes, flaps, intersections and triangles that are turned around
// mislead single lines, not the majority.
class Voxels {
 public:
  explicit Voxels(device::Device& device);

  // Voxelises a mesh, `cells` along its longest side, without what is cut away. `passes` gets what it took.
  void update(const PathMesh& mesh, std::uint32_t cells, const gpu::PathTools& tools, std::vector<PassStats>& passes);

  const gpu::PathGrid& grid() const { return grid_; }
  SolidCells cells() const { return {grid_, flags_, wanted_}; }
  std::uint32_t solid() const { return solid_; }  // cells

  // uint per cell: 1 + the largest of the triangles that cross it, 0 without one.
  const device::Buffer& triangle() const { return triangle_; }

  // Invocations for each triangle and axis of passes over crossings.
  static std::uint32_t stripes(const PathMesh& mesh);

 private:
  void fit(const PathMesh& mesh, std::uint32_t cells, std::vector<PassStats>& passes);

  device::Device& device_;
  device::ComputePass box_pass_, crossings_pass_, winding_pass_, solid_pass_;
  device::Buffer box_, crossings_, flags_, triangle_, wanted_, counts_;
  gpu::PathGrid grid_{};
  std::uint32_t solid_ = 0;
};

}  // namespace quadgraph
