// What the exitance is off by because the irradiance is: where shadow maps put the edges of shadows, what stands for a
// light of some size, and the rays by which light from all around enters.
//
// Whoever knows the lights samples how far q is off, twice (shaders/light/light_error.comp). Both samples are solved
// for as light that is scattered at the surface, and the mean product of what then leaves is the square of the error
// without the noise of either: an edge that is off by half a texel hardly counts where light spreads by many.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "engine/reference/solution.h"
#include "engine/solve/assembly.h"
#include "engine/solve/level_solver.h"
#include "engine/solve/operators.h"
#include "engine/solve/workspace.h"

namespace quadgraph {

// The solution whose error is to be told, on the finest level.
struct LitSolution {
  Workspace& work;
  const LevelBuffers& level;
  Operators& operators;       // those of `key` have rows of the present coefficients on all levels
  OperatorKey key;            // fem and diffusion
  const Boundary& boundary;   // of that operator
  const SurfaceField& field;  // position and normal are not looked at
  float unlit = 0;            // W/mm^2, as of gpu::Scale
  glm::dvec3 share{0};        // per channel, of light that is scattered at the surface: what of it counts
};

class LightError {
 public:
  static constexpr std::uint32_t samples = 2;

  // `level`: the finest, whose faces stay what they are.
  LightError(device::Device& device, const Level& level);

  // Whoever knows the lights writes it: q less than it is by this, W/mm^2, vec3 per sample and face.
  const device::Buffer& difference() const { return difference_; }

  // Relative RMS of the means over patches of the surface, by part. Throws SolverError as LevelSolver.
  ErrorEstimate estimate(const LitSolution& solution);

 private:
  std::vector<glm::vec3> change(const LitSolution& solution, std::uint32_t sample);
  ErrorEstimate relative(const LitSolution& solution, std::span<const glm::vec3> a, std::span<const glm::vec3> b) const;

  std::vector<std::uint32_t> patch_;  // per face
  device::Buffer difference_;
  device::Buffer load_, change_;          // vec3 per vertex: b and x
  device::Buffer phi_, exitance_, clip_;  // of the change (surface_results.h)
};

// The share of LitSolution: what leaves of light that is scattered at the surface of a deep body, and what has left of
// that of the lights. boundary: of the diffusion; optical: all coefficients of the body, which are taken in the mean.
glm::dvec3 share_of_surface_light(const Energy& energy, const Boundary& boundary,
                                  std::span<const gpu::Optical> optical);

// Puts it into a report: as a part of the error, and into all of that, where all is known.
void add_light_error(SolveReport& report, const ErrorEstimate& light);

}  // namespace quadgraph
