#include "engine/reference/smooth_normals.h"

#include <glm/geometric.hpp>

#include "engine/reference/entering.h"
#include "shaders/shared/creases.h"

namespace quadgraph {
namespace {

glm::dvec3 weighed_normal(const Level& level, std::uint32_t f, int corner) {
  const auto at = [&](int k) { return glm::dvec3(level.vertices[level.faces[f][k % 3]]); };
  const glm::dvec3 a = at(corner + 1) - at(corner), b = at(corner + 2) - at(corner);
  return glm::cross(a, b) / (glm::dot(a, a) * glm::dot(b, b));
}

}  // namespace

glm::dvec3 normal_at(const CornerNormals& corners, const glm::dvec3& barycentric) {
  return glm::normalize(barycentric[0] * corners[0] + barycentric[1] * corners[1] + barycentric[2] * corners[2]);
}

std::vector<CornerNormals> smooth_normals(const Level& level) {
  struct Corner {
    std::uint32_t face;
    int place;
  };
  std::vector<std::vector<Corner>> around(level.vertices.size());
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    for (int k = 0; k < 3 && !level.reflecting(f); ++k) around[level.faces[f][k]].push_back({f, k});
  }
  std::vector<CornerNormals> normals;
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    const glm::dvec3 own = frame_of(level, f).normal;
    normals.push_back({own, own, own});
    for (std::size_t k = 0; k < 3 && !level.reflecting(f); ++k) {
      glm::dvec3 sum(0);
      for (const Corner& other : around[level.faces[f][static_cast<int>(k)]]) {
        const glm::dvec3 normal = weighed_normal(level, other.face, other.place);
        sum += double{gpu::smooth_share(static_cast<float>(glm::dot(own, glm::normalize(normal))))} * normal;
      }
      normals.back()[k] = glm::normalize(sum);
    }
  }
  return normals;
}

}  // namespace quadgraph
