// What the shortest-path method is asked (docs/shortest-path.md).
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "engine/base/names.h"
#include "engine/base/range.h"

namespace quadgraph {

// What a mm of path costs.
enum class PathCost {
  transport,   // sigma_tr = sqrt(sigma_a / kappa): the diffusion equation's own
  extinction,  // sigma_t' = sigma_a + sigma_s', as published [SOP 2.1]
};

// What a path is.
enum class PathSolver {
  eikonal,  // any line: |grad length| = cost, first order
  lattice,  // steps to the 26 neighbours, as published [SOP 2.1]; up to 13% too long
};

template <>
struct Names<PathCost> {
  static constexpr std::string_view what = "path cost";
  static constexpr auto values = std::to_array<Named<PathCost>>(
      {{PathCost::transport, "transport", "the effective transport coefficient"},
       {PathCost::extinction, "extinction", "the reduced extinction coefficient, as published"}});
};

template <>
struct Names<PathSolver> {
  static constexpr std::string_view what = "path solver";
  static constexpr auto values = std::to_array<Named<PathSolver>>(
      {{PathSolver::eikonal, "eikonal", "any path"},
       {PathSolver::lattice, "lattice", "steps between the 26 neighbours of a voxel, as published"}});
};

struct PathOptions {
  PathCost cost = PathCost::transport;
  PathSolver solver = PathSolver::eikonal;
  std::uint32_t cells = 64;  // along the longest side of the body, in path_cells_range

  bool operator==(const PathOptions&) const = default;
};

inline constexpr Range path_cells_range{.low = 8, .high = 150};

// Throws InputError naming what is out of range.
void check_options(const PathOptions& options);

}  // namespace quadgraph
