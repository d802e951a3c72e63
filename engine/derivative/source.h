// The buried source with derivatives: what lights, and what enters again, leave along their rays.
#pragma once

#include <cstddef>
#include <cstdint>
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

// The rays of `walk` step by step, with the derivatives of what each leaves; light.again stays.
class WalkedRays {
 public:
  WalkedRays(const Level& level, const Problem& problem, const Parameters& at, const Entering& light);

  // The derivative of `walk` along a direction.
  Walked tangent(const Level& level, const Parameters& along) const;
  // Adds the derivatives of the weighted results of `walk` to a gradient.
  void adjoint(const Walked& weights, Parameters& gradient) const;

 private:
  friend class StepRecorder;

  // By sigma_s' and sigma_a of the step's tet, and by the power that comes to it.
  struct Derivative {
    glm::dvec3 by_scattering{0}, by_absorption{0}, by_power{0};
  };
  // What a step leaves at a vertex, or above all vertices at an outside face.
  struct Deposit {
    std::uint32_t to;
    Derivative by;
  };
  struct Step {
    std::uint32_t tet;
    std::size_t first_deposit;
    Derivative passed;  // power that comes to the next step
  };
  struct WalkedRay {
    std::uint32_t light;  // none for light that enters again
    std::size_t first_step;
    glm::dvec3 by_power;  // of the light: power that comes to the first step
  };
  static constexpr std::uint32_t none = UINT32_MAX;

  std::size_t end_of_steps(std::size_t ray) const {
    return ray + 1 < rays_.size() ? rays_[ray + 1].first_step : steps_.size();
  }
  std::size_t end_of_deposits(std::size_t step) const {
    return step + 1 < steps_.size() ? steps_[step + 1].first_deposit : deposits_.size();
  }

  std::uint32_t vertices_;
  std::vector<WalkedRay> rays_;
  std::vector<Step> steps_;
  std::vector<Deposit> deposits_;
};

}  // namespace quadgraph
