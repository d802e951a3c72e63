#include "engine/base/path_options.h"

#include <string>

#include "engine/base/error.h"

namespace quadgraph {

PathCost path_cost_from_name(std::string_view name) {
  for (const PathCost cost : {PathCost::transport, PathCost::extinction}) {
    if (name_of(cost) == name) return cost;
  }
  throw InputError("path cost '" + std::string(name) + "': allowed are transport, extinction");
}

PathSolver path_solver_from_name(std::string_view name) {
  for (const PathSolver solver : {PathSolver::eikonal, PathSolver::lattice}) {
    if (name_of(solver) == name) return solver;
  }
  throw InputError("path solver '" + std::string(name) + "': allowed are eikonal, lattice");
}

std::string_view name_of(PathCost cost) {
  return cost == PathCost::transport ? "transport" : "extinction";
}

std::string_view name_of(PathSolver solver) {
  return solver == PathSolver::eikonal ? "eikonal" : "lattice";
}

void check_options(const PathOptions& options) {
  if (options.cells < least_path_cells || options.cells > most_path_cells) {
    throw InputError("path cells: found " + std::to_string(options.cells) + ", allowed are " +
                     std::to_string(least_path_cells) + " to " + std::to_string(most_path_cells));
  }
}

}  // namespace quadgraph
