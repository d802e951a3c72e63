#include "engine/graph/ray.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "engine/graph/fresnel.h"

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

// What a crossing of a tet is about to do: rates of the coordinates times 6 V, and the sign of the tet's corners.
struct Rates {
  std::array<double, 4> rate;
  double six_volume;
};

Rates rates_along(const glm::dvec3& direction, const glm::dvec3& p0, const glm::dvec3& p1, const glm::dvec3& p2,
                  const glm::dvec3& p3) {
  const glm::dvec3 e1 = p1 - p0, e2 = p2 - p0, e3 = p3 - p0;
  const glm::dvec3 n1 = glm::cross(e2, e3), n2 = glm::cross(e3, e1), n3 = glm::cross(e1, e2);
  const double determinant = glm::dot(e1, n1);
  const glm::dvec3 d = determinant < 0 ? -direction : direction;
  const double r1 = glm::dot(n1, d), r2 = glm::dot(n2, d), r3 = glm::dot(n3, d);
  return {{-(r1 + r2 + r3), r1, r2, r3}, std::abs(determinant)};
}

}  // namespace

void Ray::run(std::uint32_t f, const glm::dvec3& barycentric, const glm::dvec3& direction, const glm::dvec3& power) {
  enter(f, barycentric);
  direction_ = direction;
  power_ = start_ = power;
  for (std::uint32_t step = 0; step < gpu::MAX_WALK_STEPS; ++step) {
    const int exit = cross();
    if (exit < 0 || (ended() && extinction() != glm::dvec3(0))) return stop();
    const auto out = static_cast<std::size_t>(exit);
    const std::uint32_t next = level_.links[tet_][local_of(corners_[out].vertex)];
    std::swap(corners_[out], corners_[3]);
    if (next < level_.tet_count()) {
      pass_to(next);
    } else {
      meet_surface(next - level_.tet_count());
      if (power_ == glm::dvec3(0)) return;
    }
  }
  stop();
}

void Ray::enter(std::uint32_t f, const glm::dvec3& barycentric) {
  tet_ = level_.face_tets[f];
  const glm::uvec3& face = level_.faces[f];
  for (int k = 0; k < 3; ++k) set(static_cast<std::size_t>(k), face[k], barycentric[k]);
  const glm::uvec4& tet = level_.tets[tet_];
  set(3, tet[0] + tet[1] + tet[2] + tet[3] - face[0] - face[1] - face[2], 0.0);
}

void Ray::set(std::size_t k, std::uint32_t vertex, double lambda) {
  corners_[k] = {vertex, glm::dvec3(level_.vertices[vertex]), lambda};
}

int Ray::local_of(std::uint32_t vertex) const {
  int k = 0;
  while (k < 3 && level_.tets[tet_][k] != vertex) ++k;
  return k;
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

// Follows the ray to the face where it leaves the tet, and leaves there what scatters and is absorbed on the way.
// Returns the corner opposite to that face; -1 if rounding left no way out.
int Ray::cross() {
  const auto [rate, six_volume] =
      rates_along(direction_, corners_[0].position, corners_[1].position, corners_[2].position, corners_[3].position);
  int exit = -1;
  std::size_t out = 0;
  for (std::size_t k = 0; k < 3; ++k) {  // never back through the face opposite to corner 3
    if (rate[k] >= 0) continue;
    if (exit >= 0 && corners_[k].lambda * rate[out] <= corners_[out].lambda * rate[k]) continue;
    exit = static_cast<int>(k);
    out = k;
  }
  if (exit < 0) return exit;
  const double ratio = corners_[out].lambda / rate[out];
  std::array<double, 4> lambda;
  double sum = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    lambda[k] = k == out ? 0.0 : std::max(0.0, corners_[k].lambda - ratio * rate[k]);
    sum += lambda[k];
  }
  for (double& l : lambda) l /= sum;
  leave(lambda, -ratio * six_volume);
  return exit;
}

// Scatters and absorbs along `length` mm, to the coordinates `lambda`.
void Ray::leave(const std::array<double, 4>& lambda, double length) {
  const glm::dvec3 scattering = albedo(), tau = extinction() * length;
  for (int c = 0; c < 3; ++c) {
    const Taken part = taken(tau[c]);
    result_.absorbed[c] += power_[c] * (1 - scattering[c]) * part.whole;
    const double scattered = power_[c] * scattering[c];
    for (std::size_t k = 0; k < 4; ++k) {
      const double moved = lambda[k] - corners_[k].lambda;
      deposit(k, c, scattered * (corners_[k].lambda * part.whole + moved * part.moment));
    }
    power_[c] *= std::exp(-tau[c]);
  }
  for (std::size_t k = 0; k < 4; ++k) corners_[k].lambda = lambda[k];
}

void Ray::deposit(std::size_t k, int c, double watt) {
  const std::uint32_t carrier = problem_.method == Method::fem ? corners_[k].vertex : tet_;
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
    for (std::size_t k = 0; k < 4; ++k) deposit(k, c, power_[c] * scattering[c] * corners_[k].lambda);
    result_.absorbed[c] += power_[c] * (1 - scattering[c]);
  }
}

// At outside face f, opposite to corner 3.
void Ray::meet_surface(std::uint32_t f) {
  const glm::dvec3 p = corners_[0].position;
  glm::dvec3 normal = glm::normalize(glm::cross(corners_[1].position - p, corners_[2].position - p));
  if (glm::dot(normal, corners_[3].position - p) > 0) normal = -normal;
  const double mu = std::clamp(glm::dot(direction_, normal), 0.0, 1.0);
  if (!level_.reflecting(f)) {
    const glm::dvec3 out = (1.0 - internal_reflectance(mu, problem_.eta)) * power_;
    result_.unscattered[f] += out;
    result_.unscattered_out += out;
    power_ -= out;
  }
  direction_ = glm::normalize(direction_ - 2.0 * mu * normal);
}

void Ray::pass_to(std::uint32_t next) {
  const glm::uvec4& tet = level_.tets[next];
  tet_ = next;
  set(3, tet[0] + tet[1] + tet[2] + tet[3] - corners_[0].vertex - corners_[1].vertex - corners_[2].vertex, 0.0);
}

}  // namespace quadgraph
