// One ray of the buried source; see source_walk.h.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>

#include "engine/optics/fresnel.h"
#include "engine/reference/attenuation.h"
#include "engine/reference/operator.h"
#include "engine/reference/tet_ray.h"
#include "shaders/solver/solve_shared.h"

namespace quadgraph {

// `Medium` is one of medium.h. What the ray leaves goes to `Sink`, by channel, in W:
//   scattered(carrier, channel, power), absorbed(channel, power), unscattered(face, channel, power) and
//   trapped(channel, power), of light that stays in a clear region.
// Before that it is told begins(power) of a ray and steps(tet, power), by channel, of each tet that it comes to.
// A ray ends where each channel has kept less than `end` of its power.
template <class Medium, class Sink>
class Ray {
 public:
  using Real = typename Medium::Real;
  using Power = std::array<Real, 3>;

  Ray(const Level& level, const Problem& problem, const Medium& medium, Sink& sink, double end)
      : level_(level), problem_(problem), medium_(medium), sink_(sink), end_(end), way_(level) {}

  // From the point with coordinates `barycentric` of outside face f, with `power` (W) along `direction` (unit, inside).
  void run(std::uint32_t f, const glm::dvec3& barycentric, const glm::dvec3& direction, const Power& power) {
    way_.start_on_face(f, barycentric);
    direction_ = direction;
    power_ = power;
    for (std::size_t c = 0; c < 3; ++c) start_[c] = value_of(power[c]);
    sink_.begins(power_);
    for (std::uint32_t step = 0; step < gpu::MAX_WALK_STEPS; ++step) {
      sink_.steps(way_.tet(), power_);
      const TetRay::Exit exit = way_.find_exit(direction_);
      if (!exit.found) return stop();
      const bool clear = scatter(exit);
      const std::uint32_t next = way_.leave(exit);
      if (!clear && kept_less_than(end_)) return stop();
      if (next < level_.tet_count()) {
        way_.enter(next);
      } else {
        meet_surface(next - level_.tet_count());
        if (kept_less_than(0)) return;
      }
    }
    sink_.steps(way_.tet(), power_);
    stop();
  }

 private:
  // Whether no channel has kept more than this share of what it began with.
  bool kept_less_than(double share) const {
    for (std::size_t c = 0; c < 3; ++c) {
      if (value_of(power_[c]) > share * start_[c]) return false;
    }
    return true;
  }

  // Scatters and absorbs on the way to the exit; returns whether the tet does neither in any channel.
  bool scatter(const TetRay::Exit& exit) {
    using std::exp;
    bool clear = true;
    for (int c = 0; c < 3; ++c) {
      Real& power = power_[static_cast<std::size_t>(c)];
      const Coefficients<Real> here = medium_.at(way_.tet(), c);
      const Real tau = here.extinction() * exit.length, passing = power * exit.length;
      clear = clear && value_of(here.extinction()) == 0;
      sink_.absorbed(c, passing * here.absorption * weighted(1.0, 1.0, tau));
      const Real scattered = passing * here.scattering;
      for (std::size_t k = 0; k < 4; ++k) {
        deposit(k, c, scattered * weighted(way_.corner(k).lambda, exit.lambda[k], tau));
      }
      power = power * exp(-tau);
    }
    return clear;
  }

  void deposit(std::size_t k, int c, const Real& watt) {
    sink_.scattered(on_vertices(problem_.method) ? way_.corner(k).vertex : way_.tet(), c, watt);
  }

  // All that is left stays here; in a clear region it is counted as having left.
  void stop() {
    for (int c = 0; c < 3; ++c) {
      const Real& power = power_[static_cast<std::size_t>(c)];
      const Coefficients<Real> here = medium_.at(way_.tet(), c);
      if (value_of(here.extinction()) == 0) {
        sink_.trapped(c, power);
        continue;
      }
      const Real albedo = here.albedo();
      for (std::size_t k = 0; k < 4; ++k) deposit(k, c, power * albedo * way_.corner(k).lambda);
      sink_.absorbed(c, power * (1.0 - albedo));
    }
  }

  // At outside face f, opposite to corner 3.
  void meet_surface(std::uint32_t f) {
    const glm::dvec3 normal = way_.face_normal();
    if (!level_.reflecting(f)) {
      const double mu = std::clamp(glm::dot(direction_, normal), 0.0, 1.0);
      const double inside = internal_reflectance(mu, problem_.eta.behind(level_, f));
      for (int c = 0; c < 3; ++c) {
        Real& power = power_[static_cast<std::size_t>(c)];
        const Real out = (1.0 - inside) * power;
        sink_.unscattered(f, c, out);
        power = power - out;
      }
    }
    direction_ = mirrored(direction_, normal);
  }

  const Level& level_;
  const Problem& problem_;
  const Medium& medium_;
  Sink& sink_;
  double end_;
  TetRay way_;
  glm::dvec3 direction_{0};
  Power power_{};
  std::array<double, 3> start_{};
};

}  // namespace quadgraph
