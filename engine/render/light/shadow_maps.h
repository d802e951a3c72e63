// What each light sees of the display mesh, as depth in buffers that the shaders of shaders/light/lights.glsl read.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "engine/base/pass_stats.h"
#include "engine/device/commands.h"
#include "engine/render/display/display_buffers.h"
#include "engine/render/light/light_set.h"
#include "shaders/light/render_shared.h"

namespace quadgraph {

class ShadowMaps {
 public:
  explicit ShadowMaps(device::Device& device);

  // Draws the maps of `lights`, in place of those before, whose memory they take over where it is as large. What the
  // same view has shown of the same mesh stays.
  PassStats update(const DisplayBuffers& mesh, const LightSet& lights);

  // The mesh has changed.
  void forget() { drawn_.clear(); }

  std::uint32_t light_count() const { return light_count_; }
  bool shaped() const { return shaped_; }                   // as LightSet
  const device::Buffer& lights() const { return lights_; }  // LightRecord per light
  const device::Buffer& shapes() const { return shapes_; }  // LightShape per light
  const device::Buffer& views() const { return views_; }    // ShadowView, those of the first light first

 private:
  // A piece of a buffer.
  struct Place {
    std::size_t buffer = 0;
    std::uint64_t offset = 0;
  };

  device::Image& image_for(std::size_t view, std::uint32_t size);
  std::uint64_t address_of(const Place& place) const;
  std::uint64_t take_drawn(std::size_t view, gpu::ShadowView wanted);
  void make_places(const std::vector<gpu::ShadowView>& views);
  std::uint64_t copy_to_place(device::Commands& commands, const device::Image& image, std::size_t view);
  PassStats draw(const DisplayBuffers& mesh, std::span<gpu::ShadowView> views, std::size_t first);

  device::Device& device_;
  device::GraphicsPass pass_;
  std::uint32_t light_count_ = 0;
  bool shaped_ = false;
  device::Buffer lights_;
  device::Buffer shapes_;
  device::Buffer views_;
  std::vector<gpu::ShadowView> drawn_;  // what the maps show, with their addresses
  // Where images are read in place, an image per view; else images by size, and buffers copied from them: one per view,
  // or, as devices allow some thousand buffers only, where there are many views large ones that they share.
  std::map<std::uint32_t, device::Image> images_;
  std::vector<device::Image> maps_;
  std::vector<device::Buffer> depths_;
  std::vector<Place> places_;                      // of views in depths_
  std::map<std::uint32_t, device::Buffer> whole_;  // by size, between an image and its place; where buffers are shared
};

}  // namespace quadgraph
