#include "engine/reference/tet_ray.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

namespace quadgraph {
namespace {

// Rates of the coordinates along a direction times 6 V, and 6 V.
struct Rates {
  std::array<double, 4> rate;
  double six_volume;
};

Rates rates_along(const glm::dvec3& direction, const std::array<TetRay::Corner, 4>& corners) {
  const glm::dvec3 p = corners[0].position;
  const glm::dvec3 e1 = corners[1].position - p, e2 = corners[2].position - p, e3 = corners[3].position - p;
  const glm::dvec3 n1 = glm::cross(e2, e3), n2 = glm::cross(e3, e1), n3 = glm::cross(e1, e2);
  const double determinant = glm::dot(e1, n1);
  const glm::dvec3 d = determinant < 0 ? -direction : direction;
  const double r1 = glm::dot(n1, d), r2 = glm::dot(n2, d), r3 = glm::dot(n3, d);
  return {{-(r1 + r2 + r3), r1, r2, r3}, std::abs(determinant)};
}

}  // namespace

void TetRay::start_on_face(std::uint32_t f, const glm::dvec3& barycentric) {
  tet_ = level_.face_tets[f];
  ways_out_ = 3;
  const glm::uvec3& face = level_.faces[f];
  for (int k = 0; k < 3; ++k) set(static_cast<std::size_t>(k), face[k], barycentric[k]);
  const glm::uvec4& tet = level_.tets[tet_];
  set(3, tet[0] + tet[1] + tet[2] + tet[3] - face[0] - face[1] - face[2], 0.0);
}

void TetRay::start_at_vertex(std::uint32_t v, std::uint32_t tet) {
  tet_ = tet;
  ways_out_ = 4;
  for (int k = 0; k < 4; ++k) {
    const std::uint32_t vertex = level_.tets[tet][k];
    set(static_cast<std::size_t>(k), vertex, vertex == v ? 1.0 : 0.0);
  }
}

void TetRay::set(std::size_t k, std::uint32_t vertex, double lambda) {
  corners_[k] = {vertex, glm::dvec3(level_.vertices[vertex]), lambda};
}

TetRay::Exit TetRay::find_exit(const glm::dvec3& direction) const {
  const auto [rate, six_volume] = rates_along(direction, corners_);
  Exit exit;
  for (std::size_t k = 0; k < ways_out_; ++k) {
    if (rate[k] >= 0) continue;
    if (exit.found && corners_[k].lambda * rate[exit.slot] <= corners_[exit.slot].lambda * rate[k]) continue;
    exit.found = true;
    exit.slot = k;
  }
  if (!exit.found) return exit;
  const double ratio = corners_[exit.slot].lambda / rate[exit.slot];
  double sum = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    exit.lambda[k] = k == exit.slot ? 0.0 : std::max(0.0, corners_[k].lambda - ratio * rate[k]);
    sum += exit.lambda[k];
  }
  for (double& l : exit.lambda) l /= sum;
  exit.length = -ratio * six_volume;
  return exit;
}

std::uint32_t TetRay::leave(const Exit& exit) {
  for (std::size_t k = 0; k < 4; ++k) corners_[k].lambda = exit.lambda[k];
  int place = 0;
  while (place < 3 && level_.tets[tet_][place] != corners_[exit.slot].vertex) ++place;
  std::swap(corners_[exit.slot], corners_[3]);
  ways_out_ = 3;
  return level_.links[tet_][place];
}

void TetRay::enter(std::uint32_t next) {
  const glm::uvec4& tet = level_.tets[next];
  tet_ = next;
  set(3, tet[0] + tet[1] + tet[2] + tet[3] - corners_[0].vertex - corners_[1].vertex - corners_[2].vertex, 0.0);
}

glm::dvec3 TetRay::face_normal() const {
  const glm::dvec3 p = corners_[0].position;
  const glm::dvec3 n = glm::normalize(glm::cross(corners_[1].position - p, corners_[2].position - p));
  return glm::dot(n, corners_[3].position - p) > 0 ? -n : n;
}

std::uint32_t TetRay::quarter_of(std::uint32_t f) const {
  for (std::size_t k = 0; k < 3; ++k) {
    if (corners_[k].lambda <= 0.5) continue;
    for (std::uint32_t j = 0; j < 3; ++j) {
      if (level_.faces[f][static_cast<int>(j)] == corners_[k].vertex) return j;
    }
  }
  return 3;
}

glm::dvec3 TetRay::at_point(std::span<const glm::dvec3> values) const {
  glm::dvec3 sum(0);
  for (const Corner& corner : corners_) sum += corner.lambda * values[corner.vertex];
  return sum;
}

glm::dvec3 TetRay::at_exit(std::span<const glm::dvec3> values, const Exit& exit) const {
  glm::dvec3 sum(0);
  for (std::size_t k = 0; k < 4; ++k) sum += exit.lambda[k] * values[corners_[k].vertex];
  return sum;
}

glm::dvec3 mirrored(const glm::dvec3& direction, const glm::dvec3& n) {
  return glm::normalize(direction - 2.0 * glm::dot(direction, n) * n);
}

}  // namespace quadgraph
