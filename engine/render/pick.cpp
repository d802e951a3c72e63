#include "engine/render/pick.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>

namespace quadgraph {

std::optional<Picked> pick(const DisplayMesh& mesh, std::span<const glm::vec3> vertices, const Camera& camera,
                           float vertical_fov, float aspect, const glm::vec2& at) {
  const float half = std::tan(0.5f * glm::radians(vertical_fov));
  const glm::dvec3 origin(camera.eye);
  const glm::dvec3 direction(
      glm::normalize(aspect * half * at.x * camera.right + half * at.y * camera.up - camera.backward));
  double nearest = std::numeric_limits<double>::max();
  std::optional<Picked> found;
  for (const glm::uvec3& t : mesh.triangles) {
    // Moeller and Trumbore 1997.
    const glm::dvec3 a(vertices[t.x]), ab = glm::dvec3(vertices[t.y]) - a, ac = glm::dvec3(vertices[t.z]) - a;
    const glm::dvec3 p = glm::cross(direction, ac);
    const double det = glm::dot(ab, p);
    if (det == 0) continue;
    const double u = glm::dot(origin - a, p) / det;
    const glm::dvec3 q = glm::cross(origin - a, ab);
    const double v = glm::dot(direction, q) / det, distance = glm::dot(ac, q) / det;
    if (u < 0 || v < 0 || u + v > 1 || distance <= 0 || distance >= nearest) continue;
    nearest = distance;
    const glm::vec3 share(1 - u - v, u, v);
    found = Picked{glm::vec3(origin + distance * direction),
                   share.x * mesh.vertices[t.x] + share.y * mesh.vertices[t.y] + share.z * mesh.vertices[t.z],
                   glm::vec3(glm::normalize(glm::cross(ab, ac)))};
  }
  return found;
}

}  // namespace quadgraph
