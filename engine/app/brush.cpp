#include "engine/app/brush.h"

#include <glm/geometric.hpp>

namespace quadgraph {
namespace {

constexpr float reach = 1.0f / 15, stride = 0.3f;  // of the body's radius; of the brush's

}  // namespace

Brush Brush::for_body(float radius) {
  Brush brush;
  brush.edit.sigma_a = glm::vec3(3);
  brush.edit.radius = reach * radius;
  brush.edit.depth_to = reach * radius;
  brush.edit.softness = 0.5f * reach * radius;
  return brush;
}

void Brush::begin(Scene& scene, const glm::vec3& at) const {
  scene.edits.push_back(edit);
  scene.edits.back().stroke = {at};
}

void Brush::lead(Scene& scene, const glm::vec3& at) const {
  std::vector<glm::vec3>& stroke = scene.edits.back().stroke;
  if (glm::distance(stroke.back(), at) > stride * edit.radius) stroke.push_back(at);
}

}  // namespace quadgraph
