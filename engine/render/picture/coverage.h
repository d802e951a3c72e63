// How much of each pixel of a tile the body covers, where its silhouette may cross it.
#pragma once

#include <optional>

#include "engine/device/commands.h"
#include "engine/render/picture/frame_offsets.h"

namespace quadgraph {

class Coverage {
 public:
  explicit Coverage(device::Device& device) : device_(device) {}

  // For tiles of so many pixels, at most. Not while commands that were recorded wait.
  void make_room(std::uint32_t width, std::uint32_t height);

  // After the samples `seen` of a tile have been drawn, of so many triangles of the display mesh.
  void record(device::Commands& commands, const gpu::TilePixels& tile, std::uint64_t scene, std::uint64_t seen,
              std::uint32_t triangles, const CoveragePlaces& places);

  std::uint64_t covered() const { return pixels_.address(); }  // gpu::PixelCoverage per pixel of the tile
  std::uint64_t marked() const {
    return covered() + pixels_.size() - marked_bytes_;
  }  // shaders/display/silhouette.comp

 private:
  device::Device& device_;
  std::optional<device::ComputePass> silhouette_, coverage_;  // made at first use
  device::Buffer places_, pixels_;
  std::uint64_t marked_bytes_ = 0;  // of pixels_, the last
};

}  // namespace quadgraph
