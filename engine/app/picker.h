// What lies under the pointer, told at any time: also while the engine computes.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "engine/app/outline.h"
#include "engine/render/display/pick.h"
#include "engine/scene/stage.h"

namespace quadgraph {

class Picker {
 public:
  // Takes up body, shape and cuts of what the stage shows. The stage must keep its engine until the next call.
  void follow(Stage& stage);

  // As the function pick, of what was followed last; empty before.
  std::optional<Picked> pick(const Camera& camera, const glm::vec2& at) const;

  // As the function nearest_to, of what was followed last.
  std::optional<Picked> nearest_to(const glm::vec3& at_rest) const;

  // The number of the body that was picked, of those that the file names.
  std::uint32_t body_of(const Picked& picked) const;

  // As the function outline_of, of what was followed last.
  std::vector<Segment> outline(std::uint32_t body, const Camera& camera, float aspect) const;

  // mm, the middle of the body's box at rest.
  glm::vec3 middle() const;

 private:
  const QuadGraph* graph_ = nullptr;
  std::shared_ptr<const std::vector<glm::vec3>> vertices_;  // mm, where they are now
  std::vector<gpu::PathTool> tools_;
};

}  // namespace quadgraph
