// What each light sees of the display mesh, as depth in buffers that the shaders of shaders/light/lights.glsl read.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "engine/base/pass_stats.h"
#include "engine/render/display/display_buffers.h"
#include "engine/render/light/light_set.h"
#include "engine/vk/commands.h"
#include "shaders/light/render_shared.h"

namespace quadgraph {

class ShadowMaps {
 public:
  explicit ShadowMaps(vk::Context& context);

  // Draws the maps of `lights`, in place of those before, whose memory they take over where it is as large.
  PassStats update(const DisplayBuffers& mesh, const LightSet& lights);

  std::uint32_t light_count() const { return light_count_; }
  bool shaped() const { return shaped_; }               // as LightSet
  const vk::Buffer& lights() const { return lights_; }  // LightRecord per light
  const vk::Buffer& shapes() const { return shapes_; }  // LightShape per light
  const vk::Buffer& views() const { return views_; }    // ShadowView, those of the first light first

 private:
  vk::Context& context_;
  vk::GraphicsPass pass_;
  std::uint32_t light_count_ = 0;
  bool shaped_ = false;
  vk::Buffer lights_;
  vk::Buffer shapes_;
  vk::Buffer views_;
  std::map<std::uint32_t, vk::Image> images_;  // what is drawn into, by size
  std::vector<vk::Buffer> depths_;             // per view
};

}  // namespace quadgraph
