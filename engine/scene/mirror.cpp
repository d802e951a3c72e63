#include "engine/scene/mirror.h"

#include <cmath>
#include <glm/geometric.hpp>

#include "engine/scene/gestures.h"

namespace quadgraph {
namespace {

int axis_of(Mirror mirror) {
  return static_cast<int>(mirror) - 1;
}

}  // namespace

std::array<std::string, 4> mirror_names(float front, UpAxis up) {
  const glm::vec3 forward = towards({.azimuth = front, .elevation = 0}, up);
  const int upright = up == UpAxis::y ? 1 : 2, across = up == UpAxis::y ? 2 : 1;
  const bool turned = std::abs(forward.x) > std::abs(forward[across]);  // the body looks along x
  std::array<std::string, 4> names{"off", "left-right", "left-right", "left-right"};
  names[static_cast<std::size_t>(upright + 1)] = "top-bottom";
  names[static_cast<std::size_t>(turned ? 1 : across + 1)] = "front-back";
  for (std::size_t axis = 0; axis < 3; ++axis) names[axis + 1] += " (" + std::string(1, "XYZ"[axis]) + ")";
  return names;
}

glm::vec3 mirrored(const glm::vec3& point, Mirror mirror, const glm::vec3& middle) {
  const int axis = axis_of(mirror);
  glm::vec3 image = point;
  image[axis] = 2 * middle[axis] - point[axis];
  return image;
}

TouchPlace mirrored(const TouchPlace& place, Mirror mirror, const Picked& nearest) {
  const glm::vec3 outward = glm::normalize(nearest.to_rest * nearest.normal);
  const auto along = [&](const glm::vec3& direction) {
    const glm::vec3 image = mirrored(direction, mirror, glm::vec3(0));
    return image - glm::dot(image, outward) * outward;
  };
  glm::vec3 upright = along(place.upright);
  if (glm::length(upright) < least_sine) upright = along(place.inward);
  return {nearest.at_rest, -outward, glm::normalize(upright)};
}

}  // namespace quadgraph
