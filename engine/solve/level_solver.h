// Solves one level on the device from the x it holds.
#pragma once

#include "engine/solve/operator_buffers.h"
#include "engine/solve/workspace.h"

namespace quadgraph {

// Runs what is recorded, then iterates until the tolerance or the limit of `options` is reached, or until single
// precision allows no more (converged = false). b and its norm must be in place. Throws SolverError naming level,
// iteration and channel.
LevelReport solve_level(Workspace& work, OperatorBuffers& op, std::uint32_t level, const SolveOptions& options);

}  // namespace quadgraph
