// Inter-reflection between points of a body's surface (docs/physics.md, "Inter-reflection"), on the CPU in double
// precision, over the rows `seen` of a level: the answer the GPU is compared with.
//
// What leaves a face, its radiosity J, arrives elsewhere as irradiance E along the rays of docs/qgraph-format.md. The
// share T_d = diffuse_transmittance(eta) of E enters, as uniform light does, and the surface reflects the rest as a
// diffuser would: J = M + (1 - T_d) E. Light that the surface reflects on its first arrival, and unscattered light that
// leaves, are not followed.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/reference/received.h"
#include "engine/reference/reference.h"

namespace quadgraph {

// Share of the cosine-weighted directions from each outside face that meet the sky; all 1 if the level has no rows.
std::vector<double> sky_visibility(const Level& level);

struct BouncedSolution {
  ReferenceSolution solution;          // under all light, energy.re_entered apart from energy.entered
  std::vector<glm::dvec3> irradiance;  // E of the last bounce, W/mm^2 per outside face
  std::vector<glm::vec3> re_entered;   // q of it, T_d E, W/mm^2 per outside face
  std::vector<glm::dvec3> bounces;     // W per channel that each bounce brought in
  bool converged = true;               // false if the bounces ended before the criterion was met
};

inline constexpr std::uint32_t max_bounces = 64;

// solve_reference on one level, and again with what re-enters as a beam of BEAM_MEAN, until a bounce changes it by no
// more than a tenth of options.tolerance of what entered in every channel, or max_bounces are done; with
// options.bounces > 0 so many bounces from none. Each takes M of the solve and E of the bounce before. None where
// bounces_wanted is false or the level sees nothing of itself.
BouncedSolution solve_with_bounces(const Level& level, std::span<const gpu::Optical> optical, const Indices& eta,
                                   std::span<const EnteringLight> lights, const SolveOptions& options,
                                   Entries entries = Entries::exact);

}  // namespace quadgraph
