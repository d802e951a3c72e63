// Where light matters to what leaves each part of the surface alike, bright or dim: the adjoint of the diffusion
// solution, which steers random walks (docs/physics.md, "Certificate").
#pragma once

#include <vector>

#include "engine/solve/perturbation.h"

namespace quadgraph {

// Per vertex of the finest level and channel, above zero; its mean over the light on the faces is 1. `level`: that
// level. Throws SolverError as LevelSolver.
std::vector<glm::vec3> importance_of(Perturbation& perturbation, const PerturbedSolution& solution, const Level& level);

}  // namespace quadgraph
