#include "engine/render/display/normal_map.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>

namespace quadgraph {

float NormalMap::spread() const {
  const glm::vec3 whole = slopes->texels.back();
  return strength * strength * std::max(whole.z - whole.x * whole.x - whole.y * whole.y, 0.0f);
}

Placement around(std::span<const glm::vec3> vertices, float front) {
  constexpr float room = 1.001f, least = 1e-6f;  // beyond the outermost vertices, and of a side of the largest
  const float angle = glm::radians(front);
  const glm::vec3 up{0, 1, 0}, direction{-std::sin(angle), 0, -std::cos(angle)}, right = glm::cross(direction, up);
  glm::vec3 low(std::numeric_limits<float>::max()), high = -low;
  for (const glm::vec3& vertex : vertices) {
    const glm::vec3 at{glm::dot(vertex, right), vertex.y, glm::dot(vertex, direction)};
    low = glm::min(low, at);
    high = glm::max(high, at);
  }
  const glm::vec3 middle = 0.5f * (low + high), size = high - low;
  const float longest = std::max({size.x, size.y, size.z});
  return {.centre = middle.x * right + middle.y * up + middle.z * direction,
          .direction = direction,
          .up = up,
          .size = room * glm::max(size, glm::vec3(least * longest))};
}

}  // namespace quadgraph
