#include "engine/solve/fluence.h"

#include <limits>

#include "engine/reference/tet_locator.h"

namespace quadgraph {

Fluence fluence(Simulation& simulation, Method method) {
  std::vector<glm::vec3> values = simulation.phi();
  const Level& level = simulation.present_level();
  const std::span<const glm::vec3> points = on_vertices(method) ? level.vertices : level.nodes;
  return {{points.begin(), points.end()}, std::move(values)};
}

std::vector<glm::vec3> fluence_at(Simulation& simulation, Method method, std::span<const glm::vec3> points) {
  const std::vector<glm::vec3> phi = simulation.phi();
  const Level& level = simulation.present_level();
  const TetLocator locator(level);
  const auto value = [&](const TetLocator::Place& place) {
    if (!on_vertices(method)) return phi[place.tet];
    glm::dvec3 sum(0);
    for (int corner = 0; corner < 4; ++corner) {
      sum += place.barycentric[corner] * glm::dvec3(phi[level.tets[place.tet][corner]]);
    }
    return glm::vec3(sum);
  };
  std::vector<glm::vec3> found;
  found.reserve(points.size());
  for (const glm::vec3& point : points) {
    const auto place = locator.find(glm::dvec3(point));
    found.push_back(place ? value(*place) : glm::vec3(std::numeric_limits<float>::quiet_NaN()));
  }
  return found;
}

}  // namespace quadgraph
