#include "engine/render/picture/picture_buffers.h"

namespace quadgraph {
namespace {

constexpr std::array<const char*, PICTURE_LAYERS> names = {"picture/scattered", "picture/specular",
                                                           "picture/unscattered", "picture/transmittance"};

void grow(device::Device& device, std::uint64_t bytes, const char* name, device::Buffer& buffer) {
  if (buffer.size() < bytes) buffer = device::Buffer(device, bytes, device::Place::device, name);
}

std::vector<float> floats(device::Device& device, const device::Buffer& buffer, std::uint64_t count) {
  std::vector<float> values(count);
  device::read_bytes(device, buffer, std::as_writable_bytes(std::span(values)));
  return values;
}

}  // namespace

void PictureBuffers::resize(device::Device& device, std::uint32_t new_width, std::uint32_t new_height) {
  width = new_width;
  height = new_height;
  for (std::size_t k = 0; k < layers.size(); ++k) grow(device, sizeof(glm::vec3) * pixels(), names[k], layers[k]);
  grow(device, sizeof(float) * pixels(), "picture/alpha", alpha);
}

void PictureBuffers::make_room_around(device::Device& device) {
  grow(device, sizeof(glm::vec3) * pixels(), "picture/surroundings", around);
}

void PictureBuffers::make_room_doubt(device::Device& device) {
  grow(device, sizeof(gpu::PixelDoubt) * pixels(), "picture/doubt", doubt);
}

Picture read_picture(device::Device& device, const PictureBuffers& buffers) {
  const auto rgb = [&](std::size_t k) { return floats(device, buffers.layers[k], 3 * buffers.pixels()); };
  return {.width = buffers.width,
          .height = buffers.height,
          .scattered = rgb(0),
          .specular = rgb(1),
          .unscattered = rgb(2),
          .transmittance = rgb(3),
          .alpha = floats(device, buffers.alpha, buffers.pixels()),
          .surroundings =
              buffers.has_surroundings ? floats(device, buffers.around, 3 * buffers.pixels()) : std::vector<float>(),
          .false_colour = buffers.false_colour};
}

}  // namespace quadgraph
