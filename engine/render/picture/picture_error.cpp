#include "engine/render/picture/picture_error.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <vector>

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

Seen seen_in(const glm::vec3& scattered, const gpu::PixelDoubt& doubt, const ErrorEstimate& exitance) {
  const double covered = doubt.covered, unlit = doubt.unlit / covered;
  const double dimmest = exitance.dimmest > 0 ? doubt.dimmest / covered : 0;
  const double radiance = double{scattered.x} + scattered.y + scattered.z;
  const double bright = glm::mix(square(exitance.whole), square(exitance.unlit), unlit);
  const double relative = glm::mix(bright, square(exitance.dimmest), dimmest);
  return {radiance, square(radiance) * relative + square(angle_share * doubt.angle), unlit};
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

}  // namespace

std::optional<ErrorEstimate> picture_error(device::Device& device, const PictureBuffers& picture,
                                           const ErrorEstimate& exitance) {
  if (!picture.has_doubt) return std::nullopt;
  const std::uint64_t count = picture.pixels();
  std::vector<glm::vec3> scattered(count);
  std::vector<gpu::PixelDoubt> doubt(count);
  device::read_bytes(device, picture.layers[0], std::as_writable_bytes(std::span(scattered)));
  device::read_bytes(device, picture.doubt, std::as_writable_bytes(std::span(doubt)));
  std::vector<Seen> pixels;
  for (std::uint64_t i = 0; i < count; ++i) {
    if (doubt[i].covered > 0) pixels.push_back(seen_in(scattered[i], doubt[i], exitance));
  }
  const std::size_t third = pixels.size() / 3;
  std::nth_element(pixels.begin(), pixels.begin() + static_cast<std::ptrdiff_t>(third), pixels.end(),
                   [](const Seen& a, const Seen& b) { return a.radiance < b.radiance; });
  const auto all = [](const Seen&) { return 1.0; };
  return ErrorEstimate{.whole = relative_rms(pixels, pixels.size(), all),
                       .unlit = relative_rms(pixels, pixels.size(), [](const Seen& seen) { return seen.unlit; }),
                       .dimmest = relative_rms(pixels, third, all)};
}

}  // namespace quadgraph
