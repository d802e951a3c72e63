// Shortest optical paths from the lit cells to all others, three channels, on the device.
#pragma once

#include <optional>
#include <vector>

#include "engine/base/path_options.h"
#include "engine/path/voxels.h"

namespace quadgraph {

// A block of 8^3 cells of one channel is relaxed by one workgroup: planes of cells take, one after the other, what is
// shortest through the plane before, where that has changed, in the six directions along the axes, until the block has
// nothing left to gain. Then the blocks around that what has changed can make shorter are listed for the next round.
// There those wait that light arrives at later than it has crossed another one, which comes close to Dijkstra's order.
// Rounds are recorded beforehand with workgroup counts from the device. The lattice's answer is Dijkstra's but for
// rounding.
class PathRelaxation {
 public:
  explicit PathRelaxation(device::Device& device);

  // Room for the cells of a grid. What cost and entering hold is then undefined.
  void make_room(const gpu::PathGrid& grid);

  // Channel after channel, per cell: float, 1/mm, below 0 where it is not solid; and what enters, as the bits of a
  // float in W/mm^2, 0 where nothing does. Both are for others to write.
  const device::Buffer& cost() const { return cost_; }
  const device::Buffer& entering() const { return entering_; }

  // Lengths from -ln(entering) on. Throws SolverError if rounds do not end.
  void solve(const SolidCells& cells, PathSolver solver, std::vector<PassStats>& passes);

  // Optical lengths, stored as cost is; PATH_FAR: no light gets there. The buffer goes on with what only the
  // relaxation reads.
  const device::Buffer& lengths() const { return lengths_; }
  std::uint32_t rounds() const { return rounds_; }  // of the last solve
  std::uint32_t lit() const { return lit_; }        // cells that light enters

 private:
  const device::ComputePass& pass(PathSolver solver);

  device::Device& device_;
  device::ComputePass start_pass_, settle_pass_;
  std::optional<device::ComputePass> passes_[2];  // by PathSolver, made at first use
  device::Buffer cost_, entering_, lengths_, copies_, lists_[2], arrivals_, fronts_, groups_, counts_;
  std::uint32_t rounds_ = 0, lit_ = 0;
};

}  // namespace quadgraph
