#include "engine/scene/picker.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "engine/deform/deformer.h"

namespace quadgraph {
namespace {

constexpr int ring_points = 48;

// Empty where part of it lies behind the eye.
Ring ring_around(const Picked& middle, float radius, const Camera& camera) {
  const glm::vec3 side = std::abs(middle.normal.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
  const glm::vec3 u = glm::normalize(glm::cross(middle.normal, side)), v = glm::cross(middle.normal, u);
  Ring ring;
  for (int i = 0; i < ring_points; ++i) {
    const float angle = glm::radians(360.0f * static_cast<float>(i) / ring_points);
    const glm::vec4 clip = camera.clip(middle.position + radius * (std::cos(angle) * u + std::sin(angle) * v));
    if (clip.w <= 0) return {};
    ring.emplace_back(clip.x / clip.w, clip.y / clip.w);
  }
  return ring;
}

// Whether a place of the surface looks towards the eye.
bool faces(const Picked& place, const Camera& camera) {
  const glm::vec3 to_eye = camera.parallel ? glm::vec3(camera.backward) : glm::vec3(camera.eye) - place.position;
  return glm::dot(place.normal, to_eye) > 0;
}

}  // namespace

void Picker::follow(Stage& stage) {
  graph_ = &stage.engine().graph();
  vertices_ = stage.engine().bounds().outline;
  tools_ = path_tools(stage.scene().cuts);
}

std::optional<Picked> Picker::pick(const Camera& camera, const glm::vec2& at) const {
  if (graph_ == nullptr) return std::nullopt;
  return quadgraph::pick(graph_->display(), *vertices_, camera, at, tools_);
}

std::optional<Touch> Picker::touch(const Camera& camera, const glm::vec2& at, Mirror mirror) const {
  const auto found = pick(camera, at);
  if (!found) return std::nullopt;
  Touch touch{touched(*found, camera)};
  touch.body = body_name(*found, *graph_);
  const auto other = other_side(*found, mirror);
  if (other) touch.mirrored = mirrored(touch.here, mirror, *other);
  return touch;
}

std::vector<Ring> Picker::rings(const Camera& camera, const glm::vec2& at, const Brush& brush) const {
  const auto found = pick(camera, at);
  if (!found) return {};
  std::vector<Ring> rings{ring_around(*found, brush.edit.radius, camera)};
  const auto other = other_side(*found, brush.mirror);
  if (other && faces(*other, camera)) rings.push_back(ring_around(*other, brush.edit.radius, camera));
  std::erase_if(rings, [](const Ring& ring) { return ring.empty(); });
  return rings;
}

std::uint32_t Picker::body_of(const Picked& picked) const {
  return graph_ == nullptr ? 0 : quadgraph::body_of(picked, *graph_);
}

std::vector<Segment> Picker::outline(std::uint32_t body, const Camera& camera, float aspect) const {
  if (graph_ == nullptr) return {};
  return outline_of(*graph_, *vertices_, body, camera, aspect);
}

// The place on the other side of the body, where the brush paints both: in the mirror through the middle of its box at
// rest.
std::optional<Picked> Picker::other_side(const Picked& found, Mirror mirror) const {
  if (mirror == Mirror::off) return std::nullopt;
  const RestBox box = rest_box(graph_->display().vertices);
  const glm::vec3 middle(0.5 * (box.low + box.high));
  return nearest_to(graph_->display(), *vertices_, mirrored(found.at_rest, mirror, middle));
}

}  // namespace quadgraph
