// Solvers of the operator's rows on one level, in double precision.
#pragma once

#include <functional>
#include <vector>

#include "engine/reference/operator.h"
#include "engine/reference/solution.h"

namespace quadgraph {

// A x = b from x = 0 to `options.tolerance`: conjugate gradients preconditioned by the diagonal blocks, or, for
// unsymmetric methods and solvers that relax, plain relaxation. Iterations, residual and whether it is small enough go
// to `report`. `check` is called once an iteration; what it throws ends the solve. Throws SolverError as
// solve_reference does.
std::vector<Field> solve_rows(const Rows& rows, const std::vector<Field>& b, const SolveOptions& options,
                              LevelReport& report, const std::function<void()>& check = {});

}  // namespace quadgraph
