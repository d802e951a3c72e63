// CPU reference solver in double precision, without Vulkan: the answer the GPU is compared with.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/graph/graph.h"
#include "engine/graph/operator.h"
#include "engine/graph/solution.h"

namespace quadgraph {

struct ReferenceSolution {
  std::vector<glm::dvec3> phi;       // W/mm^2 per unknown of the method
  std::vector<glm::dvec3> phi_face;  // W/mm^2 per surface node (fem: mean of the face's vertices)
  std::vector<glm::dvec3> exitance;  // W/mm^2 per surface node, M = (phi - 2q) / (2A)
  Energy energy;
  LevelReport report;
};

// Evaluates a material at every node of a level.
std::vector<gpu::Optical> evaluate_material(const Level& level, const gpu::Material& material);

// Solves one level from zero to `options.tolerance` (cascade: plain relaxation on this level). Throws InputError as
// `assemble` does, SolverError if conjugate gradients meet a direction of non-positive energy or the residual is no
// longer finite.
ReferenceSolution solve_reference(const Level& level, std::span<const gpu::Optical> optical, double eta,
                                  std::span<const glm::vec3> q, const SolveOptions& options);

}  // namespace quadgraph
