#include "engine/reference/vertex_starts.h"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <limits>
#include <queue>
#include <span>
#include <tuple>

namespace quadgraph {
namespace {

constexpr std::uint32_t none = 0xffffffffu;

// Neighbours of vertex v: neighbour[offset[v]] ... neighbour[offset[v + 1] - 1], with repetitions.
struct Neighbours {
  std::vector<std::uint32_t> offset, neighbour;
};

Neighbours neighbours_of(const Level& level, const Listener& listener) {
  Neighbours result;
  result.offset.assign(level.vertices.size() + 1, 0);
  for (std::size_t t = 0; t < level.tets.size(); ++t) {
    heed(listener, t);
    for (int k = 0; k < 4; ++k) result.offset[level.tets[t][k] + 1] += 3;
  }
  for (std::size_t v = 1; v < result.offset.size(); ++v) result.offset[v] += result.offset[v - 1];
  result.neighbour.resize(result.offset.back());
  std::vector<std::uint32_t> next(result.offset.begin(), result.offset.end() - 1);
  for (std::size_t t = 0; t < level.tets.size(); ++t) {
    heed(listener, t);
    const glm::uvec4& tet = level.tets[t];
    for (int k = 0; k < 4; ++k) {
      for (int j = 1; j < 4; ++j) result.neighbour[next[tet[k]]++] = tet[(k + j) % 4];
    }
  }
  return result;
}

// Of each vertex the nearest of `sources`, by spreading over the edges of the tets; itself where none is reached.
std::vector<std::uint32_t> nearest_of(const Level& level, std::span<const std::uint32_t> sources,
                                      const Listener& listener) {
  std::vector<std::uint32_t> nearest(level.vertices.size(), none);
  // Distance, vertex, surface vertex: equal distances are settled by number, so that the answer is one.
  using Offer = std::tuple<double, std::uint32_t, std::uint32_t>;
  std::priority_queue<Offer, std::vector<Offer>, std::greater<>> offers;
  constexpr Offer nothing{std::numeric_limits<double>::infinity(), none, none};
  std::vector<Offer> best(level.vertices.size(), nothing);
  for (const std::uint32_t source : sources) offers.emplace(0.0, source, source);
  const Neighbours around = neighbours_of(level, listener);
  for (std::size_t taken = 0; !offers.empty(); ++taken) {
    heed(listener, taken);
    const auto [distance, v, s] = offers.top();
    offers.pop();
    if (nearest[v] != none) continue;
    nearest[v] = s;
    for (std::uint32_t e = around.offset[v]; e < around.offset[v + 1]; ++e) {
      const std::uint32_t u = around.neighbour[e];
      if (nearest[u] != none) continue;
      const Offer offer{glm::distance(glm::dvec3(level.vertices[u]), glm::dvec3(level.vertices[s])), u, s};
      if (offer >= best[u]) continue;
      best[u] = offer;
      offers.push(offer);
    }
  }
  for (std::uint32_t v = 0; v < nearest.size(); ++v) {
    if (nearest[v] == none) nearest[v] = v;
  }
  return nearest;
}

// Corners of the open faces, with repetitions.
std::vector<std::uint32_t> open_vertices(const Level& level) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    if (level.reflecting(f)) continue;
    for (int k = 0; k < 3; ++k) found.push_back(level.faces[f][k]);
  }
  return found;
}

// Sine of the angle by which `direction` lies inside the cone of the tet at its corner k; negative outside.
double inside_by(const Level& level, const glm::uvec4& tet, int k, const glm::dvec3& direction) {
  const glm::dvec3 apex(level.vertices[tet[k]]);
  std::array<glm::dvec3, 3> edge;
  for (int j = 0; j < 3; ++j) {
    edge[static_cast<std::size_t>(j)] = glm::dvec3(level.vertices[tet[(k + 1 + j) % 4]]) - apex;
  }
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t j = 0; j < 3; ++j) {
    const glm::dvec3 normal = glm::normalize(glm::cross(edge[(j + 1) % 3], edge[(j + 2) % 3]));
    const double side = glm::dot(normal, edge[j]) < 0 ? -1 : 1;
    least = std::min(least, side * glm::dot(normal, direction));
  }
  return least;
}

}  // namespace

std::vector<glm::dvec3> open_normals(const Level& level) {
  std::vector<glm::dvec3> normal(level.vertices.size(), glm::dvec3(0));
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    if (level.reflecting(f)) continue;
    const glm::uvec3& face = level.faces[f];
    const glm::dvec3 p(level.vertices[face[0]]);
    const glm::dvec3 n = glm::cross(glm::dvec3(level.vertices[face[1]]) - p, glm::dvec3(level.vertices[face[2]]) - p);
    for (int k = 0; k < 3; ++k) normal[face[k]] += n;
  }
  for (glm::dvec3& n : normal) {
    const double length = glm::length(n);
    n = length > 0 ? n / length : glm::dvec3(0);
  }
  return normal;
}

std::vector<std::uint32_t> nearest_boundary(const Level& level, const Listener& listener) {
  std::vector<std::uint32_t> sources;
  for (std::uint32_t t = 0; t < level.tet_count(); ++t) {
    for (int k = 0; k < 4; ++k) {
      const std::uint32_t other = level.links[t][k];
      if (other >= level.tet_count() || level.body_of_tet(other) == level.body_of_tet(t)) continue;
      for (int j = 1; j < 4; ++j) sources.push_back(level.tets[t][(k + j) % 4]);
    }
  }
  if (sources.empty()) return {};
  const std::vector<std::uint32_t> open = open_vertices(level);
  sources.insert(sources.end(), open.begin(), open.end());
  return nearest_of(level, sources, listener);
}

VertexStarts vertex_starts(const Level& level, const Listener& listener) {
  VertexStarts result{nearest_of(level, open_vertices(level), listener),
                      std::vector<std::uint32_t>(level.vertices.size(), 0)};
  const std::vector<glm::dvec3> normal = open_normals(level);
  std::vector<double> best(level.vertices.size(), -std::numeric_limits<double>::infinity());
  for (std::uint32_t t = 0; t < level.tet_count(); ++t) {
    heed(listener, t);
    for (int k = 0; k < 4; ++k) {
      const std::uint32_t v = level.tets[t][k];
      const double inside = inside_by(level, level.tets[t], k, normal[result.nearest[v]]);
      if (inside > best[v]) {
        best[v] = inside;
        result.start[v] = t;
      }
    }
  }
  return result;
}

}  // namespace quadgraph
