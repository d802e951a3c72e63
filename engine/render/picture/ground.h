// The ground on which the body stands: seen only by the shadow where they meet, and by what it gets of the body's
// light.
#pragma once

#include <optional>
#include <vector>

#include "engine/base/pass_stats.h"
#include "engine/device/pipeline.h"
#include "engine/render/display/camera.h"
#include "engine/render/display/display_buffers.h"
#include "engine/render/picture/ground_light.h"
#include "engine/render/picture/picture_buffers.h"

namespace quadgraph {

class Ground {
 public:
  explicit Ground(device::Device& device);

  // The body has another shape.
  void invalidate() { made_for_.reset(); }

  // Other light leaves it.
  void relight() { lit_ = false; }

  // Darkens the picture beside the body, as coverage, and adds to its scattered light what a diffuser of the albedo
  // GROUND_ALBEDO sends back of the body's. `bounds` holds the mesh; without a source there is the shadow alone.
  std::vector<PassStats> run(const DisplayBuffers& mesh, const Sphere& bounds, const View& view, const Camera& camera,
                             const PictureBuffers& picture, const std::optional<GroundSource>& source);

 private:
  void make_map(const DisplayBuffers& mesh, const Sphere& bounds, UpAxis up);
  void record_light(device::Commands& commands, const GroundSource& source);

  device::Device& device_;
  device::GraphicsPass below_;
  device::ComputePass map_, ground_;
  device::Image image_;
  device::Buffer depth_, shadow_;
  std::optional<UpAxis> made_for_;
  glm::vec3 middle_{0};                          // mm, of the maps, on the ground
  float half_width_ = 0, light_half_width_ = 0;  // mm
  std::optional<GroundLight> light_;             // made at first use
  bool lit_ = false;                             // it is that of the present shape and light
};

}  // namespace quadgraph
