// What each light sees of the display mesh, as depth in buffers that the shaders of shaders/lights.glsl read.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "engine/render/camera.h"
#include "engine/render/display_buffers.h"
#include "engine/render/lights.h"
#include "engine/solve/simulation.h"
#include "engine/vk/commands.h"
#include "shaders/render_shared.h"

namespace quadgraph {

// The views of one light that together see all of `bounds` (depth address left 0): one orthographic view of a
// directional light, one perspective view of a point light outside 1.1 times the sphere, else six of 90 degrees.
std::vector<gpu::ShadowView> shadow_views(const Light& light, const Sphere& bounds);

// As shaders take it, without views.
gpu::LightRecord light_record(const Light& light);

class ShadowMaps {
 public:
  explicit ShadowMaps(vk::Context& context);

  // Draws the maps of `lights`, in place of those before, whose memory they take over where it is as large. `bounds`
  // holds the mesh.
  PassStats update(const DisplayBuffers& mesh, const Sphere& bounds, std::span<const Light> lights);

  std::uint32_t light_count() const { return light_count_; }
  const vk::Buffer& lights() const { return lights_; }  // LightRecord per light
  const vk::Buffer& views() const { return views_; }    // ShadowView, those of the first light first

 private:
  vk::Context& context_;
  vk::GraphicsPass pass_;
  std::uint32_t light_count_ = 0;
  vk::Buffer lights_;
  vk::Buffer views_;
  std::map<std::uint32_t, vk::Image> images_;  // what is drawn into, by size
  std::vector<vk::Buffer> depths_;             // per view
};

}  // namespace quadgraph
