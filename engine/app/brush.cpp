#include "engine/app/brush.h"

#include <algorithm>
#include <glm/geometric.hpp>

namespace quadgraph {
namespace {

constexpr float reach = 1.0f / 15, stride = 0.3f;  // of the body's radius; of the brush's
constexpr float least_sine = 0.1f;                 // of the angle between a surface's normal and what is upright on it

}  // namespace

Touch touched(const Picked& picked, const Camera& camera) {
  const glm::vec3 outward = glm::normalize(picked.to_rest * picked.normal);
  const auto along = [&](const glm::vec3& direction) {
    const glm::vec3 there = picked.to_rest * (direction - glm::dot(direction, picked.normal) * picked.normal);
    return there - glm::dot(there, outward) * outward;
  };
  glm::vec3 upright = along(camera.up);
  if (glm::length(upright) < least_sine * glm::length(picked.to_rest * camera.up)) upright = along(-camera.backward);
  return {picked.at_rest, -outward, glm::normalize(upright)};
}

Brush Brush::for_body(float radius) {
  Brush brush;
  brush.edit.sigma_a = glm::vec3(3);
  brush.edit.radius = reach * radius;
  brush.edit.depth_to = reach * radius;
  brush.edit.softness = 0.5f * reach * radius;
  return brush;
}

Edit Brush::stamp(const Touch& touch) const {
  const ImagePyramid& shape = edit.image ? *edit.image : *edit.mask;
  const float longest = static_cast<float>(std::max(shape.columns, shape.rows));
  const float width = 2 * edit.radius * static_cast<float>(shape.columns) / longest;
  const float height = 2 * edit.radius * static_cast<float>(shape.rows) / longest;
  Edit stamped = edit;
  stamped.radius = 0;
  stamped.softness = std::min(edit.softness, 0.25f * std::min(width, height));
  stamped.placement = Placement{touch.at, touch.inward, touch.upright, {width, height, 2 * edit.radius}};
  return stamped;
}

void Brush::begin(Scene& scene, const Touch& touch) const {
  if (stamps()) return scene.edits.push_back(stamp(touch));
  scene.edits.push_back(edit);
  scene.edits.back().stroke = {touch.at};
}

void Brush::lead(Scene& scene, const Touch& touch) const {
  if (stamps()) {
    scene.edits.back() = stamp(touch);
    return;
  }
  std::vector<glm::vec3>& stroke = scene.edits.back().stroke;
  if (glm::distance(stroke.back(), touch.at) > stride * edit.radius) stroke.push_back(touch.at);
}

}  // namespace quadgraph
