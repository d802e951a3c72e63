// A picture on the device: what the rasteriser leaves there, and what is read back as a Picture.
#pragma once

#include <array>
#include <cstdint>

#include "engine/device/memory.h"
#include "engine/render/picture/picture.h"
#include "shaders/light/render_shared.h"

namespace quadgraph {

// The layers of Picture, row after row, the top one first. Buffers may be longer than the picture.
struct PictureBuffers {
  std::uint32_t width = 0, height = 0;                // pixels
  std::array<device::Buffer, PICTURE_LAYERS> layers;  // vec3 per pixel: scattered, specular, unscattered, transmittance
  device::Buffer alpha;                               // float per pixel
  device::Buffer around;                              // vec3 per pixel: surroundings, if has_surroundings
  device::Buffer doubt;                               // PixelDoubt per pixel, if has_doubt
  bool has_surroundings = false;
  bool has_doubt = false;
  bool false_colour = false;  // as in Picture

  std::uint64_t pixels() const { return std::uint64_t{width} * height; }

  // Takes the size, and memory for it where there is too little.
  void resize(device::Device& device, std::uint32_t new_width, std::uint32_t new_height);
  void make_room_around(device::Device& device);
  void make_room_doubt(device::Device& device);
};

Picture read_picture(device::Device& device, const PictureBuffers& buffers);

}  // namespace quadgraph
