// What the exitance of a solution changes by, to first order, where something is not what it was solved for: one more
// solve with the operator of the correction, as means over patches of the surface.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "engine/reference/solution.h"
#include "engine/solve/assembly.h"
#include "engine/solve/level_solver.h"
#include "engine/solve/operators.h"
#include "engine/solve/workspace.h"

namespace quadgraph {

// The solution, on the finest level.
struct PerturbedSolution {
  Workspace& work;
  const LevelBuffers& level;
  Operators& operators;              // those of `key` have rows of the present coefficients on all levels
  OperatorKey key;                   // fem and diffusion
  const BodyBoundaries& boundaries;  // of that operator
  const SurfaceField& field;         // position and normal are not looked at
  float unlit = 0;                   // W/mm^2, as of gpu::Scale
};

class Perturbation {
 public:
  // `level`: the finest, whose faces stay what they are.
  Perturbation(device::Device& device, const Level& level);

  // W/mm^2 per face: what a load brings, of which `record` makes b of the operator, scaled. Throws SolverError as
  // LevelSolver.
  std::vector<glm::vec3> exitance(const PerturbedSolution& solution,
                                  const std::function<void(OperatorBuffers&)>& record);

  // The same of a load of one vec3 per vertex, scaled.
  std::vector<glm::vec3> exitance(const PerturbedSolution& solution, std::span<const glm::vec3> load);

  // Per vertex, scaled: the fluence that such a load brings.
  std::vector<glm::vec3> fluence(const PerturbedSolution& solution, std::span<const glm::vec3> load);

  // The patch of each face (surface_parts.h).
  std::span<const std::uint32_t> patches() const { return patch_; }

  // Relative RMS of the means over patches of the surface, by part: root of the mean product of two changes of which
  // `counts` does, per channel, but for the noise of either. Of one change its own.
  ErrorEstimate relative(const PerturbedSolution& solution, std::span<const glm::vec3> a, std::span<const glm::vec3> b,
                         const glm::dvec3& counts) const;

 private:
  using Record = std::function<void(OperatorBuffers&)>;

  Record given(const PerturbedSolution& solution, std::span<const glm::vec3> load);
  void solve(const PerturbedSolution& solution, const Record& record);

  std::vector<std::uint32_t> patch_;      // per face
  device::Buffer given_;                  // vec3 per vertex: a load from the host
  device::Buffer load_, change_;          // vec3 per vertex: b and x
  device::Buffer phi_, exitance_, clip_;  // of the change (surface_results.h)
};

}  // namespace quadgraph
