#include "engine/deform/mean_value.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace quadgraph {
namespace {

// Shares of the size of the mesh, and of angles: closer than that a point lies on a vertex, on a triangle, in its
// plane.
constexpr double on_vertex = 1e-10, on_triangle = 1e-9, in_plane = 1e-8;

// Between unit vectors, to rounding also where it is near 0 or pi.
double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
  return 2 * std::atan2(glm::length(a - b), glm::length(a + b));
}

// The vertices as the point sees them.
struct Seen {
  std::vector<double> distance;
  std::vector<glm::dvec3> direction;
};

enum class Place { beside, on };

// Adds what one triangle contributes; Place::on, with the weights of its corners alone, if the point lies on it.
Place add_triangle(const Seen& seen, const glm::uvec3& ids, std::vector<double>& weight) {
  std::array<double, 3> angle, d;
  std::array<glm::dvec3, 3> u;
  double half = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    d[k] = seen.distance[ids[static_cast<int>(k)]];
    u[k] = seen.direction[ids[static_cast<int>(k)]];
  }
  for (std::size_t k = 0; k < 3; ++k) {
    angle[k] = angle_between(u[(k + 1) % 3], u[(k + 2) % 3]);
    half += angle[k] / 2;
  }
  // Cosines and sines of the angles between the planes through the sides and the point.
  std::array<double, 3> c, s;
  bool flat = false;
  const double solid = glm::dot(u[0], glm::cross(u[1], u[2]));
  for (std::size_t k = 0; k < 3; ++k) {
    const double product = std::sin(angle[(k + 1) % 3]) * std::sin(angle[(k + 2) % 3]);
    const double others = glm::dot(u[k], u[(k + 2) % 3]) * glm::dot(u[k], u[(k + 1) % 3]);
    c[k] = (glm::dot(u[(k + 1) % 3], u[(k + 2) % 3]) - others) / product;
    s[k] = solid / product;
    flat = flat || !(std::abs(s[k]) > in_plane);
  }
  if (flat && std::numbers::pi - half < on_triangle) {
    std::fill(weight.begin(), weight.end(), 0.0);
    for (std::size_t k = 0; k < 3; ++k) {
      weight[ids[static_cast<int>(k)]] = std::sin(angle[k]) * d[(k + 1) % 3] * d[(k + 2) % 3];
    }
    return Place::on;
  }
  if (flat) return Place::beside;  // in its plane, where it contributes nothing
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
    weight[ids[static_cast<int>(k)]] +=
        (angle[k] - c[next] * angle[last] - c[last] * angle[next]) / (d[k] * std::sin(angle[next]) * s[last]);
  }
  return Place::beside;
}

std::vector<double> all_at(std::size_t count, std::size_t vertex) {
  std::vector<double> weight(count, 0.0);
  weight[vertex] = 1;
  return weight;
}

}  // namespace

std::vector<double> mean_value_weights(std::span<const glm::dvec3> vertices, std::span<const glm::uvec3> triangles,
                                       const glm::dvec3& point) {
  Seen seen;
  for (const glm::dvec3& v : vertices) {
    const glm::dvec3 away = v - point;
    seen.distance.push_back(glm::length(away));
    seen.direction.push_back(away / std::max(seen.distance.back(), 1e-300));
  }
  const auto [nearest, farthest] = std::minmax_element(seen.distance.begin(), seen.distance.end());
  const auto nearest_vertex = static_cast<std::size_t>(nearest - seen.distance.begin());
  if (*nearest <= on_vertex * *farthest) return all_at(vertices.size(), nearest_vertex);
  std::vector<double> weight(vertices.size(), 0.0);
  for (const glm::uvec3& ids : triangles) {
    if (add_triangle(seen, ids, weight) == Place::on) break;
  }
  double sum = 0, size = 0;
  for (const double w : weight) {
    sum += w;
    size += std::abs(w);
  }
  if (!(std::abs(sum) > 1e-12 * size)) return all_at(vertices.size(), nearest_vertex);
  for (double& w : weight) w /= sum;
  return weight;
}

}  // namespace quadgraph
