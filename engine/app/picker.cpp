#include "engine/app/picker.h"

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

}  // namespace quadgraph
