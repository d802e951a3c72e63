// The ground on which the body stands: seen only by the shadow where they meet.
#pragma once

#include <optional>

#include "engine/base/pass_stats.h"
#include "engine/render/display/camera.h"
#include "engine/render/display/display_buffers.h"
#include "engine/render/picture/picture_buffers.h"
#include "engine/vk/pipeline.h"

namespace quadgraph {

class Ground {
 public:
  explicit Ground(vk::Context& context);

  // The body has another shape.
  void invalidate() { made_for_.reset(); }

  // Darkens the picture beside the body, as coverage without light. `bounds` holds the mesh.
  PassStats run(const DisplayBuffers& mesh, const Sphere& bounds, const View& view, const Camera& camera,
                const PictureBuffers& picture);

 private:
  void make_map(const DisplayBuffers& mesh, const Sphere& bounds, UpAxis up);

  vk::Context& context_;
  vk::GraphicsPass below_;
  vk::ComputePass map_, ground_;
  vk::Image image_;
  vk::Buffer depth_, shadow_;
  std::optional<UpAxis> made_for_;
  glm::vec3 middle_{0};   // mm, of the map, on the ground
  float half_width_ = 0;  // mm
};

}  // namespace quadgraph
