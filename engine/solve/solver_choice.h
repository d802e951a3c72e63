// Which solver takes less time on a body and a material: both are tried, once.
#pragma once

#include <functional>
#include <map>
#include <span>
#include <string>

#include "engine/reference/solution.h"
#include "engine/solve/operators.h"
#include "engine/solve/recorder.h"

namespace quadgraph {

// What can be had where `wanted`, never automatic, is asked for, and why it is another; empty if it is that.
struct PossibleSolver {
  SolverKind solver;
  std::string replaced;
};

// The operators of `key` have been created. Throws InputError for dpcg on a matrix that is not symmetric.
PossibleSolver possible_solver(Operators& operators, const OperatorKey& key, SolverKind wanted);

class SolverChoice {
 public:
  // After a change of material or shape.
  void forget() { quicker_.clear(); }

  // Solves with what is known to be quicker; else, from nothing and to the end, with both, and the report says so.
  // `cycles`: whether multigrid is possible. `passes` tells those of all runs of this solve so far.
  SolveReport solve(const OperatorKey& key, const SolveOptions& options, bool cycles,
                    const std::function<SolveReport(SolverKind)>& run,
                    const std::function<std::vector<PassStats>()>& passes);

 private:
  std::map<OperatorKey, SolverKind> quicker_;
};

}  // namespace quadgraph
