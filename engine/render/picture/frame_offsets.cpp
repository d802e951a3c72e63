#include "engine/render/picture/frame_offsets.h"

#include <cmath>
#include <numbers>
#include <numeric>

namespace quadgraph {
namespace {

// In [0, 1)^2: the first two dimensions of Sobol's sequence.
glm::dvec2 sobol(std::uint32_t index) {
  std::uint32_t x = 0, y = 0, first = 1u << 31, second = 1u << 31;
  for (; index > 0; index >>= 1) {
    if ((index & 1u) == 1) {
      x ^= first;
      y ^= second;
    }
    first >>= 1;
    second ^= second >> 1;
  }
  return std::ldexp(1.0, -32) * glm::dvec2(x, y);
}

glm::dvec2 mean_of_sobol(std::uint32_t count) {
  glm::dvec2 sum(0);
  for (std::uint32_t i = 0; i < count; ++i) sum += sobol(i);
  return sum / static_cast<double>(count);
}

// Near the golden section of `count`, and without a divisor in common with it.
std::uint32_t stride_of(std::uint32_t count) {
  auto stride = static_cast<std::uint32_t>(std::lround(count / std::numbers::phi));
  while (std::gcd(stride, count) != 1) ++stride;
  return stride;
}

}  // namespace

FrameOffset frame_offset(std::uint32_t index, std::uint32_t count, PixelFilter filter) {
  if (count == 1) return {};
  const std::uint64_t seed = std::uint64_t{index} * stride_of(count) % count;
  const double radius = std::sqrt((static_cast<double>(seed) + 0.5) / count);
  const double angle = 2 * std::numbers::pi * static_cast<double>(seed) / std::numbers::phi;
  // Four samples in the middles of quarters spread by a sixteenth of a square pixel already.
  const double narrower = std::sqrt(1 - 1.0 / 16 / variance(filter));
  const glm::dvec2 u = 0.5 + sobol(index) - mean_of_sobol(count);
  return {narrower * glm::dvec2(quantile(filter, u.x), quantile(filter, u.y)),
          radius * glm::dvec2(std::cos(angle), std::sin(angle))};
}

}  // namespace quadgraph
