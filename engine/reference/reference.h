// CPU reference solver in double precision, without Vulkan: the answer the GPU is compared with.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/file/graph.h"
#include "engine/reference/operator.h"
#include "engine/reference/solution.h"
#include "shaders/solver/solve_shared.h"

namespace quadgraph {

struct ReferenceSolution {
  std::vector<glm::dvec3> phi;       // W/mm^2 per carrier of the method
  std::vector<glm::dvec3> phi2;      // the same; 0 with diffusion
  std::vector<glm::dvec3> phi_face;  // W/mm^2 per surface node (fem: mean of the face's vertices)
  std::vector<glm::dvec3> flux;      // W/mm^2 per surface node, M of operator.h; never negative with the buried source
  std::vector<glm::dvec3> exitance;  // the same, with fem and the buried source made even (even_exitance.h)
  std::vector<glm::dvec3> unscattered;  // W/mm^2 per surface node
  Energy energy;
  glm::dvec3 clipped{0};  // as in SolveReport
  LevelReport report;
};

// Evaluates a material at every node of a level.
std::vector<gpu::Optical> evaluate_material(const Level& level, const gpu::Material& material);

// At points in the body.
std::vector<gpu::Optical> evaluate_material(const Level& level, const gpu::Material& material,
                                            std::span<const glm::vec3> points);

// Light as it enters: a beam and what of it every outside face lets in.
struct EnteringLight {
  gpu::BeamRecord beam{};
  std::span<const glm::vec3> q;  // W/mm^2, one per outside face, uniform over the face; ignored at reflecting faces
};

// The entries of the operator in double precision, or rounded to what a device stores (stored_entries.h).
enum class Entries { exact, stored };

// SolveOptions with what the reference cannot leave to the scene: a model that is named, a solver of one level, and a
// tolerance near double precision.
constexpr SolveOptions reference_options() {
  return {.solver = SolverKind::dpcg, .model = Model::sp3, .tolerance = 1e-10, .max_iterations = 100000};
}

// Solves one level from zero to `options.tolerance` (cascade: plain relaxation on this level) under all `lights`
// together; unsymmetric methods are always relaxed. `options.model` must not be `automatic`; bounces are those of
// exchange.h, not of this. Throws InputError as `assemble` does, SolverError if conjugate gradients meet a direction of
// non-positive energy or the residual is no longer finite.
ReferenceSolution solve_reference(const Level& level, std::span<const gpu::Optical> optical, const Indices& eta,
                                  std::span<const EnteringLight> lights, const SolveOptions& options,
                                  Entries entries = Entries::exact);

inline ReferenceSolution solve_reference(const Level& level, std::span<const gpu::Optical> optical, const Indices& eta,
                                         const EnteringLight& light, const SolveOptions& options,
                                         Entries entries = Entries::exact) {
  return solve_reference(level, optical, eta, std::span(&light, 1), options, entries);
}

}  // namespace quadgraph
