#include "engine/render/picture/picture_error.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/base/listener.h"

namespace quadgraph {
namespace {

struct Seen {
  double radiance;  // channels together
  double squared;   // of its error
  double unlit;     // share of the pixel
};

double square(double x) {
  return x * x;
}

// W^2/(mm^4 sr^2) per pixel, row by row, nothing where the block has no body: square of the mean of what the compared
// pixels of its block change by with another sample of the material.
std::vector<double> medium_of_blocks(device::Device& device, const PictureBuffers& picture,
                                     std::span<const gpu::PixelDoubt> doubt) {
  struct Mean {
    double change = 0, covered = 0;
  };
  const std::uint32_t across = (picture.width + gpu::DOUBT_BLOCK - 1) / gpu::DOUBT_BLOCK,
                      down = (picture.height + gpu::DOUBT_BLOCK - 1) / gpu::DOUBT_BLOCK;
  std::vector<Mean> means(std::size_t{across} * down);
  const auto mean_at = [&](std::uint32_t x, std::uint32_t y) -> Mean& {
    return means[std::size_t{y / gpu::DOUBT_BLOCK} * across + x / gpu::DOUBT_BLOCK];
  };
  for (std::uint32_t y = 0; y < picture.height; y += gpu::DOUBT_STRIDE) {
    device.heed();
    for (std::uint32_t x = 0; x < picture.width; x += gpu::DOUBT_STRIDE) {
      const gpu::PixelDoubt& here = doubt[std::size_t{y} * picture.width + x];
      mean_at(x, y).change += here.medium;
      mean_at(x, y).covered += here.covered;
    }
  }
  std::vector<double> squared(doubt.size());
  for (std::uint32_t y = 0; y < picture.height; ++y) {
    device.heed();
    for (std::uint32_t x = 0; x < picture.width; ++x) {
      const Mean& mean = mean_at(x, y);
      const std::size_t pixel = std::size_t{y} * picture.width + x;
      if (mean.covered > 0) squared[pixel] = square(doubt[pixel].covered * mean.change / mean.covered);
    }
  }
  return squared;
}

Seen seen_in(const glm::vec3& scattered, const gpu::PixelDoubt& doubt, double medium, const ErrorEstimate& exitance) {
  const double covered = doubt.covered, unlit = doubt.unlit / covered;
  const double dimmest = exitance.dimmest > 0 ? doubt.dimmest / covered : 0;
  const double radiance = double{scattered.x} + scattered.y + scattered.z;
  const double bright = glm::mix(square(exitance.whole), square(exitance.unlit), unlit);
  const double relative = glm::mix(bright, square(exitance.dimmest), dimmest);
  return {radiance, square(radiance) * relative + square(angle_share * doubt.angle) + medium, unlit};
}

// weight: of a pixel.
template <typename Weight>
double relative_rms(const std::vector<Seen>& pixels, std::size_t count, const Weight& weight) {
  double error = 0, light = 0;
  for (std::size_t i = 0; i < count; ++i) {
    error += weight(pixels[i]) * pixels[i].squared;
    light += weight(pixels[i]) * square(pixels[i].radiance);
  }
  return light > 0 ? std::sqrt(error / light) : 0;
}

// Of all pixels that show the body; doubt_of: changes what is known of a pixel.
template <typename Doubt>
std::vector<Seen> seen_by(device::Device& device, const PictureBuffers& picture, const ErrorEstimate& exitance,
                          const Doubt& doubt_of) {
  const std::uint64_t count = picture.pixels();
  std::vector<glm::vec3> scattered(count);
  std::vector<gpu::PixelDoubt> doubt(count);
  device::read_bytes(device, picture.layers[0], std::as_writable_bytes(std::span(scattered)));
  device::read_bytes(device, picture.doubt, std::as_writable_bytes(std::span(doubt)));
  const std::vector<double> medium = medium_of_blocks(device, picture, doubt);
  std::vector<Seen> pixels;
  for (std::uint64_t i = 0; i < count; ++i) {
    heed([&] { device.heed(); }, i);
    if (doubt[i].covered > 0) pixels.push_back(seen_in(scattered[i], doubt_of(doubt[i]), medium[i], exitance));
  }
  return pixels;
}

double one(const Seen&) {
  return 1;
}

}  // namespace

std::optional<ErrorEstimate> picture_error(device::Device& device, const PictureBuffers& picture,
                                           const ErrorEstimate& exitance) {
  if (!picture.has_doubt) return std::nullopt;
  std::vector<Seen> pixels = seen_by(device, picture, exitance, [](const gpu::PixelDoubt& doubt) { return doubt; });
  const std::size_t third = pixels.size() / 3;
  std::nth_element(pixels.begin(), pixels.begin() + static_cast<std::ptrdiff_t>(third), pixels.end(),
                   [](const Seen& a, const Seen& b) { return a.radiance < b.radiance; });
  device.heed();
  return ErrorEstimate{.whole = relative_rms(pixels, pixels.size(), one),
                       .unlit = relative_rms(pixels, pixels.size(), [](const Seen& seen) { return seen.unlit; }),
                       .dimmest = relative_rms(pixels, third, one)};
}

double medium_of_picture(device::Device& device, const PictureBuffers& picture) {
  if (!picture.has_doubt) return 0;
  const auto even = [](gpu::PixelDoubt doubt) {
    doubt.angle = 0;
    return doubt;
  };
  const std::vector<Seen> pixels = seen_by(device, picture, {}, even);
  return relative_rms(pixels, pixels.size(), one);
}

}  // namespace quadgraph
