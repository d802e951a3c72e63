// What makes gathered radiance integrate to the exitance of the solve, on the CPU; shaders/gather/gather_scale.comp is
// its twin.
//
// Gathering knows the shape of the surface, but on elements of a mean free path its level is several percent low. The
// solve's exitance has the right level, but follows the shape no closer than its own moments can: where a surface bends
// within few mean free paths it is up to a tenth too low on what bulges and too high in what is hollow. So the first is
// scaled to means of the second over a mean free path.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/reference/operator.h"

namespace quadgraph {

// At a surface vertex radiance is `factor` times what is gathered, and a Lambertian exitance `rest`, but at least that
// of a Lambertian exitance `least`.
struct VertexScale {
  glm::dvec3 factor{0};
  glm::dvec3 rest{0};   // W/mm^2
  glm::dvec3 least{0};  // W/mm^2
};

// Scales of every surface vertex: factor = mean of the exitance over that of what is gathered, with the weights that
// shaders/gather/gather_shared.h states, at most GATHER_FACTOR_MAX; rest: what is then missing; least: GATHER_FLOOR of
// the exitance there, where edges are long. `gathered`: W/mm^2 per outside face (radiance.h); `exitance`: W/mm^2 per
// surface vertex.
std::vector<VertexScale> gather_scale(const Level& level, const Problem& problem, std::span<const glm::dvec3> gathered,
                                      std::span<const glm::dvec3> exitance);

}  // namespace quadgraph
