#include "engine/path/path_relaxation.h"

#include <string>

#include "engine/base/error.h"
#include "engine/path/path_pass.h"
#include "interface/path/path_relax.comp.h"
#include "interface/path/path_settle.comp.h"
#include "interface/path/path_start.comp.h"

namespace quadgraph {
namespace {

constexpr std::uint32_t rounds_at_once = 24;
// A path through a labyrinth may enter and leave every block several times; nothing that is shown comes near.
constexpr std::uint32_t most_rounds = 2048;
constexpr std::uint64_t word = sizeof(std::uint32_t);

}  // namespace

PathRelaxation::PathRelaxation(device::Device& device)
    : device_(device),
      start_pass_(device, shader::path_start),
      settle_pass_(device, shader::path_settle),
      fronts_(device, 3 * (most_rounds + 1) * word, device::Place::device, "path/fronts"),
      groups_(device, (most_rounds + 1) * sizeof(glm::uvec3), device::Place::device, "path/groups"),
      counts_(device, sizeof(gpu::PathCounts), device::Place::device, "path/counts of lit cells") {}

const device::ComputePass& PathRelaxation::pass(PathSolver solver) {
  const std::uint32_t lattice = solver == PathSolver::lattice ? 1 : 0;
  auto& pass = passes_[lattice];
  if (pass) return *pass;
  return pass.emplace(device_, shader::path_relax,
                      device::ComputeOptions{.variant = lattice, .workgroup_size = PATH_GROUP});
}

void PathRelaxation::make_room(const gpu::PathGrid& grid) {
  const std::uint64_t bytes = 3 * word * gpu::cell_count(grid);
  quadgraph::make_room(device_, cost_, bytes, device::Place::device, "path/cost");
  quadgraph::make_room(device_, entering_, bytes, device::Place::device, "path/entering");
  quadgraph::make_room(device_, lengths_, 2 * bytes, device::Place::device, "path/lengths");
  quadgraph::make_room(device_, copies_, 3 * word * block_count(grid), device::Place::device, "path/copies");
  quadgraph::make_room(device_, arrivals_, 6 * sizeof(glm::uvec2) * block_count(grid), device::Place::device,
                       "path/arrivals");
  for (device::Buffer& list : lists_) {
    quadgraph::make_room(device_, list, 3 * word * block_count(grid), device::Place::device, "path/blocks to relax");
  }
}

void PathRelaxation::solve(const SolidCells& cells, PathSolver solver, std::vector<PassStats>& passes) {
  const gpu::PathGrid& grid = cells.grid;
  const device::ComputePass& relax = pass(solver);
  const std::vector<glm::uvec3> no_groups(most_rounds + 1, glm::uvec3(0, 1, 1));
  const std::uint64_t count = gpu::cell_count(grid);
  rounds_ = 0;
  std::uint64_t relaxed = 0;  // blocks of a channel, over all rounds, and waited
  std::vector<glm::uvec3> groups;
  for (bool done = false; !done;) {
    if (rounds_ + rounds_at_once > most_rounds) {
      throw SolverError("shortest paths: not found in " + std::to_string(most_rounds) + " rounds");
    }
    run_pass(device_, "shortest paths", 0, passes, [&](device::Commands& commands) {
      if (rounds_ == 0) {
        commands.update(groups_, std::as_bytes(std::span(no_groups)));
        commands.fill(counts_, 0);
        commands.fill(fronts_, ~0u);
        commands.fill(arrivals_, ~0u);
        commands.fill(copies_, 0);
        commands.dispatch(
            start_pass_,
            gpu::PathStartPush{grid, cells.flags.address(), entering_.address(), lengths_.address(),
                               cells.wanted.address(), lists_[0].address(), groups_.address(), counts_.address()},
            count);
      }
      for (std::uint32_t k = rounds_; k < rounds_ + rounds_at_once; ++k) {
        const gpu::PathRelaxPush push{grid,
                                      cost_.address(),
                                      lengths_.address(),
                                      copies_.address(),
                                      cells.wanted.address(),
                                      lists_[k % 2].address(),
                                      lists_[(k + 1) % 2].address(),
                                      groups_.address(),
                                      arrivals_.address(),
                                      fronts_.address(),
                                      k};
        commands.dispatch_indirect(relax, push, groups_, k * sizeof(glm::uvec3));
      }
    });
    groups = device::download<glm::uvec3>(device_, groups_);
    for (std::uint32_t k = rounds_; k < rounds_ + rounds_at_once; ++k) relaxed += groups[k].x;
    rounds_ += rounds_at_once;
    done = groups[rounds_].x == 0;
  }
  run_pass(device_, "shortest paths", count * 24, passes, [&](device::Commands& commands) {
    commands.dispatch(settle_pass_, gpu::PathSettlePush{grid, lengths_.address(), copies_.address()}, count);
  });
  while (rounds_ > 0 && groups[rounds_ - 1].x == 0) --rounds_;
  // Per block of a channel: lengths and costs with a cell around, and what has changed.
  passes.back().bytes = relaxed * 4ull * (2 * 1000 + 512) + count * 28;
  lit_ = device::download<gpu::PathCounts>(device_, counts_)[0].lit;
}

}  // namespace quadgraph
