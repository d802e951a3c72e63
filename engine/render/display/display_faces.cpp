#include "engine/render/display/display_faces.h"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

namespace quadgraph {
namespace {

using Neighbours = std::vector<std::array<std::uint32_t, 3>>;  // of a face, across the edge opposite each corner

Neighbours neighbours_of(const Level& level, const Listener& listener) {
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  struct Side {
    std::uint32_t low, high, face, corner;
  };
  std::vector<Side> sides;
  sides.reserve(3 * level.faces.size());
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    heed(listener, f);
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto [low, high] =
          std::minmax(level.faces[f][static_cast<int>((k + 1) % 3)], level.faces[f][static_cast<int>((k + 2) % 3)]);
      sides.push_back({low, high, f, k});
    }
  }
  std::size_t compared = 0;
  std::sort(sides.begin(), sides.end(), [&](const Side& a, const Side& b) {
    heed(listener, compared++);
    return std::pair(a.low, a.high) < std::pair(b.low, b.high);
  });
  Neighbours neighbours(level.faces.size(), {none, none, none});
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    heed(listener, i);
    const Side &a = sides[i], &b = sides[i + 1];
    if (a.low != b.low || a.high != b.high) continue;
    neighbours[a.face][a.corner] = b.face;
    neighbours[b.face][b.corner] = a.face;
  }
  return neighbours;
}

// How a point lies to a face: over which edge it is farthest out, and how far it is from the nearest point inside the
// bounds of its plane coordinates.
struct Place {
  std::uint32_t out = 0;  // corner opposite that edge
  bool inside = false;
  double distance2 = 0;  // mm^2
};

Place place_in(const Level& level, std::uint32_t f, const glm::dvec3& point) {
  const glm::uvec3& face = level.faces[f];
  const glm::dvec3 a(level.vertices[face.x]), u = glm::dvec3(level.vertices[face.y]) - a,
                                              v = glm::dvec3(level.vertices[face.z]) - a, offset = point - a;
  const glm::dvec3 normal = glm::cross(u, v);
  const double area = std::max(glm::dot(normal, normal), std::numeric_limits<double>::min());
  glm::dvec3 l(0, glm::dot(glm::cross(offset, v), normal) / area, glm::dot(glm::cross(u, offset), normal) / area);
  l.x = 1 - l.y - l.z;
  const int least = l.x <= l.y && l.x <= l.z ? 0 : l.y <= l.z ? 1 : 2;
  const bool inside = l[least] >= 0;
  l = glm::max(l, glm::dvec3(0));
  l /= l.x + l.y + l.z;
  const glm::dvec3 off = offset - l.y * u - l.z * v;
  return {static_cast<std::uint32_t>(least), inside, glm::dot(off, off)};
}

// The nearest of the faces met on the way from `start` towards `point`.
std::pair<std::uint32_t, double> walk_to(const Level& level, const Neighbours& neighbours, std::uint32_t start,
                                         const glm::dvec3& point) {
  constexpr int longest = 64;  // a display triangle lies near the faces of its vertices
  std::pair<std::uint32_t, double> best{start, std::numeric_limits<double>::max()};
  std::uint32_t face = start;
  for (int step = 0; step < longest; ++step) {
    const Place place = place_in(level, face, point);
    if (place.distance2 < best.second) best = {face, place.distance2};
    const std::uint32_t next = neighbours[face][place.out];
    if (place.inside || next >= level.face_count()) break;
    face = next;
  }
  return best;
}

}  // namespace

std::vector<std::uint32_t> display_faces(const DisplayMesh& mesh, const Level& level, const Listener& listener) {
  const Neighbours neighbours = neighbours_of(level, listener);
  std::vector<std::uint32_t> faces;
  faces.reserve(mesh.triangles.size());
  for (const glm::uvec3& triangle : mesh.triangles) {
    heed(listener, faces.size());
    glm::dvec3 centroid(0);
    for (int k = 0; k < 3; ++k) centroid += glm::dvec3(mesh.vertices[triangle[k]]) / 3.0;
    std::pair<std::uint32_t, double> best{0, std::numeric_limits<double>::max()};
    for (int k = 0; k < 3; ++k) {
      const auto found = walk_to(level, neighbours, mesh.face[triangle[k]], centroid);
      if (found.second < best.second) best = found;
    }
    faces.push_back(best.first);
  }
  return faces;
}

}  // namespace quadgraph
