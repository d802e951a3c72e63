// What the exitance is off by because the irradiance is: where shadow maps put the edges of shadows, what stands for a
// light of some size, and the rays by which light from all around enters.
//
// Whoever knows the lights samples how far q is off, twice (shaders/light/light_error.comp). Both samples are solved
// for as light that is scattered at the surface, and the mean product of what then leaves is the square of the error
// without the noise of either: an edge that is off by half a texel hardly counts where light spreads by many.
#pragma once

#include <span>

#include "engine/solve/perturbation.h"

namespace quadgraph {

class LightError {
 public:
  static constexpr std::uint32_t samples = 2;

  // `level`: the finest, whose faces stay what they are.
  LightError(device::Device& device, const Level& level);

  // Whoever knows the lights writes it: q less than it is by this, W/mm^2, vec3 per sample and face.
  const device::Buffer& difference() const { return difference_; }

  // Relative RMS of the means over patches of the surface, by part; share: as share_of_surface_light. Throws
  // SolverError as LevelSolver.
  ErrorEstimate estimate(Perturbation& perturbation, const PerturbedSolution& solution, const glm::dvec3& share) const;

 private:
  device::Buffer difference_;
};

// What counts of light that is scattered at the surface, per channel: what leaves of it in a deep body, and what has
// left of that of the lights. k11: the least of the diffusion in any body; optical: all coefficients of the
// bodies, which are taken in the mean.
glm::dvec3 share_of_surface_light(const Energy& energy, double k11, std::span<const gpu::Optical> optical);

// Puts it into a report: as a part of the error, and into all of that, where all is known.
void add_light_error(SolveReport& report, const ErrorEstimate& light);

}  // namespace quadgraph
