#include "engine/app/picker.h"

#include "engine/deform/deformer.h"

namespace quadgraph {

void Picker::follow(Stage& stage) {
  graph_ = &stage.engine().graph();
  vertices_ = stage.engine().bounds().outline;
  tools_ = path_tools(stage.scene().cuts);
}

std::optional<Picked> Picker::pick(const Camera& camera, const glm::vec2& at) const {
  if (graph_ == nullptr) return std::nullopt;
  return quadgraph::pick(graph_->display(), *vertices_, camera, at, tools_);
}

std::optional<Picked> Picker::nearest_to(const glm::vec3& at_rest) const {
  if (graph_ == nullptr) return std::nullopt;
  return quadgraph::nearest_to(graph_->display(), *vertices_, at_rest);
}

std::uint32_t Picker::body_of(const Picked& picked) const {
  return graph_ == nullptr ? 0 : quadgraph::body_of(picked, *graph_);
}

std::vector<Segment> Picker::outline(std::uint32_t body, const Camera& camera, float aspect) const {
  if (graph_ == nullptr) return {};
  return outline_of(*graph_, *vertices_, body, camera, aspect);
}

glm::vec3 Picker::middle() const {
  if (graph_ == nullptr) return glm::vec3(0);
  const RestBox box = rest_box(graph_->display().vertices);
  return glm::vec3(0.5 * (box.low + box.high));
}

}  // namespace quadgraph
