#include "engine/reference/tet_points.h"

#include <array>
#include <cmath>
#include <numeric>

#include "shaders/shared/random.h"

namespace quadgraph {

std::vector<glm::vec3> points_in_tets(const Level& level, const Listener& listener) {
  std::vector<glm::vec3> points;
  const std::size_t count = level.tets.size();
  points.reserve(points_of_a_tet * count);
  std::uint32_t drawn = 0;
  for (std::size_t i = 0; i < points_of_a_tet * count; ++i) {
    heed(listener, i);
    const glm::uvec4& tet = level.tets[i % count];
    std::array<double, 4> weight{};  // exponential variates over their sum are even on the simplex
    for (double& each : weight) each = -std::log((0.5 + static_cast<double>(gpu::hash(drawn++))) * 0x1p-32);
    const double sum = std::accumulate(weight.begin(), weight.end(), 0.0);
    glm::dvec3 point(0);
    for (int k = 0; k < 4; ++k) point += weight[static_cast<std::size_t>(k)] / sum * glm::dvec3(level.vertices[tet[k]]);
    points.emplace_back(point);
  }
  return points;
}

}  // namespace quadgraph
