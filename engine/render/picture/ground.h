// The ground on which the body stands: seen only by the shadow where they meet.
#pragma once

#include <optional>

#include "engine/base/pass_stats.h"
#include "engine/device/pipeline.h"
#include "engine/render/display/camera.h"
#include "engine/render/display/display_buffers.h"
#include "engine/render/picture/picture_buffers.h"

namespace quadgraph {

class Ground {
 public:
  explicit Ground(device::Device& device);

  // The body has another shape.
  void invalidate() { made_for_.reset(); }

  // Darkens the picture beside the body, as coverage without light. `bounds` holds the mesh.
  PassStats run(const DisplayBuffers& mesh, const Sphere& bounds, const View& view, const Camera& camera,
                const PictureBuffers& picture);

 private:
  void make_map(const DisplayBuffers& mesh, const Sphere& bounds, UpAxis up);

  device::Device& device_;
  device::GraphicsPass below_;
  device::ComputePass map_, ground_;
  device::Image image_;
  device::Buffer depth_, shadow_;
  std::optional<UpAxis> made_for_;
  glm::vec3 middle_{0};   // mm, of the map, on the ground
  float half_width_ = 0;  // mm
};

}  // namespace quadgraph
