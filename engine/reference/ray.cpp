#include "engine/reference/ray.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "engine/optics/fresnel.h"

namespace quadgraph {
namespace {

// Shares of a segment of optical length tau: what is taken out of the ray, and its first moment along the segment.
struct Taken {
  double whole;   // 1 - e^-tau
  double moment;  // integral of tau e^(-tau s) s over s in [0, 1]
};

Taken taken(double tau) {
  const double whole = -std::expm1(-tau);
  // The closed form loses digits below; four terms of the series are exact to 1e-12 there.
  if (tau < 1e-3) return {whole, tau * (0.5 - tau * (1.0 / 3 - tau * (1.0 / 8 - tau / 30)))};
  return {whole, whole / tau - std::exp(-tau)};
}

}  // namespace

void Ray::run(std::uint32_t f, const glm::dvec3& barycentric, const glm::dvec3& direction, const glm::dvec3& power) {
  way_.start_on_face(f, barycentric);
  direction_ = direction;
  power_ = start_ = power;
  for (std::uint32_t step = 0; step < gpu::MAX_WALK_STEPS; ++step) {
    const TetRay::Exit exit = way_.find_exit(direction_);
    if (!exit.found) return stop();
    scatter(exit);
    const std::uint32_t next = way_.leave(exit);
    if (ended() && extinction() != glm::dvec3(0)) return stop();
    if (next < level_.tet_count()) {
      way_.enter(next);
    } else {
      meet_surface(next - level_.tet_count());
      if (power_ == glm::dvec3(0)) return;
    }
  }
  stop();
}

// Share of what is taken out that scatters; 0 where nothing is taken out.
glm::dvec3 Ray::albedo() const {
  const glm::dvec3 sigma_t = extinction();
  glm::dvec3 share(0);
  for (int c = 0; c < 3; ++c) {
    if (sigma_t[c] > 0) share[c] = optical().sigma_s_prime[c] / sigma_t[c];
  }
  return share;
}

bool Ray::ended() const {
  for (int c = 0; c < 3; ++c) {
    if (power_[c] > static_cast<double>(gpu::WALK_END) * start_[c]) return false;
  }
  return true;
}

// Scatters and absorbs on the way to the exit.
void Ray::scatter(const TetRay::Exit& exit) {
  const glm::dvec3 scattering = albedo(), tau = extinction() * exit.length;
  for (int c = 0; c < 3; ++c) {
    const Taken part = taken(tau[c]);
    result_.absorbed[c] += power_[c] * (1 - scattering[c]) * part.whole;
    const double scattered = power_[c] * scattering[c];
    for (std::size_t k = 0; k < 4; ++k) {
      const double here = way_.corner(k).lambda;
      deposit(k, c, scattered * (here * part.whole + (exit.lambda[k] - here) * part.moment));
    }
    power_[c] *= std::exp(-tau[c]);
  }
}

void Ray::deposit(std::size_t k, int c, double watt) {
  const std::uint32_t carrier = on_vertices(problem_.method) ? way_.corner(k).vertex : way_.tet();
  result_.scattered[carrier][c] += watt;
}

// All that is left stays here; in a clear region it is counted as having left.
void Ray::stop() {
  const glm::dvec3 scattering = albedo(), sigma_t = extinction();
  for (int c = 0; c < 3; ++c) {
    if (sigma_t[c] == 0) {
      result_.unscattered_out[c] += power_[c];
      continue;
    }
    for (std::size_t k = 0; k < 4; ++k) deposit(k, c, power_[c] * scattering[c] * way_.corner(k).lambda);
    result_.absorbed[c] += power_[c] * (1 - scattering[c]);
  }
}

// At outside face f, opposite to corner 3.
void Ray::meet_surface(std::uint32_t f) {
  const glm::dvec3 normal = way_.face_normal();
  if (!level_.reflecting(f)) {
    const double mu = std::clamp(glm::dot(direction_, normal), 0.0, 1.0);
    const glm::dvec3 out = (1.0 - internal_reflectance(mu, problem_.eta)) * power_;
    result_.unscattered[f] += out;
    result_.unscattered_out += out;
    power_ -= out;
  }
  direction_ = mirrored(direction_, normal);
}

}  // namespace quadgraph
