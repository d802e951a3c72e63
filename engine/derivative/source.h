// The buried source with derivatives: what lights, and what enters again, leave along their rays.
#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/derivative/parameters.h"
#include "engine/file/graph.h"
#include "engine/reference/operator.h"
#include "engine/reference/uncollided.h"

namespace quadgraph {

// W, or derivatives, or weights.
struct Walked {
  std::vector<glm::dvec3> scattered;    // per vertex
  std::vector<glm::dvec3> unscattered;  // per outside face

  explicit Walked(const Level& level)
      : scattered(level.vertices.size(), glm::dvec3(0)), unscattered(level.faces.size(), glm::dvec3(0)) {}
};

// Lights and the irradiance that enters again, of BEAM_MEAN, W/mm^2 per outside face.
struct Entering {
  std::span<const BeamLight> lights;
  std::span<const glm::dvec3> again;  // empty: none
  // Called face by face; what it throws ends the walk.
  std::function<void()> check;
};

// Where each channel of a ray has kept less of its power, the ray ends; at WALK_END, where the engine's do, an end that
// moves on to the next tet would be a step that no derivative sees.
inline constexpr double differentiable_end = 1e-15;

// What is left of it all.
Walked walk(const Level& level, const Problem& problem, const Parameters& at, const Entering& light);

// The derivative of `walk` along a direction; light.again stays.
Walked walk_tangent(const Level& level, const Problem& problem, const Parameters& at, const Parameters& along,
                    const Entering& light);

// Adds the derivatives of the weighted results of `walk` to a gradient; light.again stays.
void walk_adjoint(const Level& level, const Problem& problem, const Parameters& at, const Walked& weights,
                  const Entering& light, Parameters& gradient);

}  // namespace quadgraph
