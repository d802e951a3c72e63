// What the exitance is off by because every tet has one value of each coefficient: where a material has steps or bends
// within tets, what they hold is not what it is.
//
// Their value is the material's in the middle. Another place in every tet, drawn at random, would do as well; what the
// exitance changes by from one to the other, to first order, is about what either is off by.
#pragma once

#include <span>
#include <vector>

#include "engine/base/listener.h"
#include "engine/solve/perturbation.h"

namespace quadgraph {

// b of the diffusion of the correction, per vertex of `level` in its present shape: of what the operator with
// coefficients `there` lacks of that with `here`, one per tet each, at a fluence per vertex.
std::vector<glm::vec3> medium_load(const Level& level, std::span<const gpu::Optical> here,
                                   std::span<const gpu::Optical> there, std::span<const glm::vec3> fluence,
                                   const Listener& listener = {});

// Relative RMS of the means over patches of the surface, by part, of such a load. Throws SolverError as LevelSolver.
ErrorEstimate medium_error(Perturbation& perturbation, const PerturbedSolution& solution,
                           std::span<const glm::vec3> load);

// Puts it into a report: as a part of the mesh's error, into all of that, where these are known, and where it is large
// in words.
void add_medium_error(SolveReport& report, const ErrorEstimate& medium);

}  // namespace quadgraph
