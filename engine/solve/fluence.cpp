#include "engine/solve/fluence.h"

#include <limits>

#include "engine/base/error.h"
#include "engine/device/memory.h"
#include "engine/reference/tet_locator.h"
#include "engine/solve/etendue.h"

namespace quadgraph {
namespace {

constexpr std::size_t points_between_checks = 4096;

}  // namespace

Fluence fluence(Simulation& simulation, Method method) {
  std::vector<glm::vec3> values = simulation.phi();
  const Level& level = simulation.present_level();
  const std::span<const glm::vec3> points = on_vertices(method) ? level.vertices : level.nodes;
  return {{points.begin(), points.end()}, std::move(values)};
}

std::vector<glm::vec3> fluence_at(Simulation& simulation, Method method, std::span<const glm::vec3> points,
                                  const std::function<void()>& check) {
  const std::vector<glm::vec3> phi = simulation.basic_phi();
  const Level& level = simulation.present_level();
  const TetLocator locator(level);
  const auto value = [&](const TetLocator::Place& place) {
    const float counts = simulation.etendue().in_tet(level, place.tet, method);
    if (!on_vertices(method)) return counts * phi[place.tet];
    glm::dvec3 sum(0);
    for (int corner = 0; corner < 4; ++corner) {
      sum += place.barycentric[corner] * glm::dvec3(phi[level.tets[place.tet][corner]]);
    }
    return counts * glm::vec3(sum);
  };
  std::vector<glm::vec3> found;
  found.reserve(points.size());
  for (const glm::vec3& point : points) {
    if (check && found.size() % points_between_checks == 0) check();
    const auto place = locator.find(glm::dvec3(point));
    found.push_back(place ? value(*place) : glm::vec3(std::numeric_limits<float>::quiet_NaN()));
  }
  return found;
}

std::vector<gpu::Optical> tet_coefficients(device::Device& device, const Simulation& simulation, std::uint32_t number) {
  const LevelBuffers& level = simulation.level(number);
  if (!level.optical.exists()) throw InputError("coefficients: nothing was solved since the body was loaded");
  std::vector<gpu::Optical> optical = device::download<gpu::Optical>(device, level.optical);
  // Nodes of tets come first; those of faces may follow.
  if (level.even) return std::vector<gpu::Optical>(level.tet_count, optical.front());
  optical.resize(level.tet_count);
  return optical;
}

}  // namespace quadgraph
