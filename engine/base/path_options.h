// What the shortest-path method is asked (docs/shortest-path.md).
#pragma once

#include <cstdint>
#include <string_view>

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

// "transport", "extinction"; "eikonal", "lattice". Throw InputError listing the allowed names.
PathCost path_cost_from_name(std::string_view name);
PathSolver path_solver_from_name(std::string_view name);
std::string_view name_of(PathCost cost);
std::string_view name_of(PathSolver solver);

struct PathOptions {
  PathCost cost = PathCost::transport;
  PathSolver solver = PathSolver::eikonal;
  std::uint32_t cells = 64;  // along the longest side of the body, 8 to most_path_cells

  bool operator==(const PathOptions&) const = default;
};

inline constexpr std::uint32_t least_path_cells = 8, most_path_cells = 150;

// Throws InputError naming what is out of range.
void check_options(const PathOptions& options);

}  // namespace quadgraph
