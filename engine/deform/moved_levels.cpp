#include "engine/deform/moved_levels.h"

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <string>

#include "engine/base/error.h"

namespace quadgraph {
namespace {

using Corners = std::array<glm::dvec3, 4>;

Corners corners_of(std::span<const glm::vec3> vertices, const glm::uvec4& tet) {
  return {glm::dvec3(vertices[tet[0]]), glm::dvec3(vertices[tet[1]]), glm::dvec3(vertices[tet[2]]),
          glm::dvec3(vertices[tet[3]])};
}

double six_volume(const Corners& c) {
  return glm::dot(c[1] - c[0], glm::cross(c[2] - c[0], c[3] - c[0]));
}

void check(const Level& level, std::uint32_t number, std::span<const glm::vec3> positions) {
  const std::string where = "vertices of level " + std::to_string(number);
  if (positions.size() != level.vertices.size()) {
    throw InputError(where + ": " + std::to_string(positions.size()) + " positions, one for each of the " +
                     std::to_string(level.vertices.size()) + " vertices is wanted");
  }
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if (std::isfinite(positions[v].x) && std::isfinite(positions[v].y) && std::isfinite(positions[v].z)) continue;
    throw InputError(where + ": vertex " + std::to_string(v) + " is not finite");
  }
  for (std::size_t t = 0; t < level.tets.size(); ++t) {
    if (six_volume(corners_of(positions, level.tets[t])) > 0) continue;
    throw InputError(where + ": they leave tet " + std::to_string(t) +
                     " without volume or turn it inside out; a positive volume is wanted");
  }
}

// `point` carried along from one tet to the other.
glm::vec3 carried(const glm::vec3& point, const Corners& from, const Corners& to) {
  const double whole = six_volume(from);
  glm::dvec3 moved(0);
  for (std::size_t k = 0; k < 4; ++k) {
    Corners part = from;
    part[k] = glm::dvec3(point);
    moved += six_volume(part) / whole * to[k];
  }
  return glm::vec3(moved);
}

}  // namespace

void MovedLevels::move(std::uint32_t number, std::span<const glm::vec3> positions) {
  if (number >= rest_.size()) {
    throw InputError("vertices of level " + std::to_string(number) + ": there are " + std::to_string(rest_.size()) +
                     " levels");
  }
  check(rest_[number], number, positions);
  place(number, positions);
}

void MovedLevels::place(std::uint32_t number, std::span<const glm::vec3> positions) {
  const Level& rest = rest_[number];
  std::vector<glm::vec3>& nodes = nodes_[number];
  nodes.resize(rest.nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const std::size_t t = i < rest.tets.size() ? i : rest.face_tets[i - rest.tets.size()];
    nodes[i] = carried(rest.nodes[i], corners_of(rest.vertices, rest.tets[t]), corners_of(positions, rest.tets[t]));
  }
  vertices_[number].assign(positions.begin(), positions.end());
  levels_[number].vertices = vertices_[number];
  levels_[number].nodes = nodes;
}

}  // namespace quadgraph
