// What lies under the pointer, and where the brush touches it, told at any time: also while the engine computes.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "engine/render/display/outline.h"
#include "engine/render/display/pick.h"
#include "engine/scene/brush.h"
#include "engine/scene/stage.h"

namespace quadgraph {

using Ring = std::vector<glm::vec2>;  // clip coordinates

class Picker {
 public:
  // Takes up body, shape and cuts of what the stage shows. The stage must keep its engine until the next call.
  void follow(Stage& stage);

  // As the function pick, of what was followed last; empty before.
  std::optional<Picked> pick(const Camera& camera, const glm::vec2& at) const;

  // Where a brush with that mirror touches what lies there.
  std::optional<Touch> touch(const Camera& camera, const glm::vec2& at, Mirror mirror) const;

  // The brush's edge on the body around that place, and around the place on the other side where it paints both and
  // that place looks towards the eye. Empty beside the body.
  std::vector<Ring> rings(const Camera& camera, const glm::vec2& at, const Brush& brush) const;

  // The number of the body that was picked, of those that the file names.
  std::uint32_t body_of(const Picked& picked) const;

  // As the function outline_of, of what was followed last.
  std::vector<Segment> outline(std::uint32_t body, const Camera& camera, float aspect) const;

 private:
  std::optional<Picked> other_side(const Picked& found, Mirror mirror) const;

  const QuadGraph* graph_ = nullptr;
  std::shared_ptr<const std::vector<glm::vec3>> vertices_;  // mm, where they are now
  std::vector<gpu::PathTool> tools_;
};

}  // namespace quadgraph
