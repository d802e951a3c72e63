#include "engine/render/picture/frame_offsets.h"

#include <algorithm>
#include <bit>
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

FrameOffset frame_offset(const PictureFrame& frame, PixelFilter filter) {
  const auto [index, count] = frame;
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

CoveragePlaces coverage_places(const PictureFrame& frame, PixelFilter filter) {
  const auto [index, count] = frame;
  const PixelFilter used = count == 1 ? PixelFilter::box : filter;
  const glm::dvec2 moved = frame_offset(frame, filter).pixel * glm::dvec2(1, -1);
  // Each frame has another part of each square of a net (a (0, 2)-sequence), in the middle of which all are together.
  const double middle = 0.5 / static_cast<double>(std::uint64_t{gpu::COVERAGE_PLACES} * std::bit_ceil(count));
  CoveragePlaces found{.places = {}, .reach = 0};
  for (std::uint32_t k = 0; k < gpu::COVERAGE_PLACES; ++k) {
    const glm::dvec2 u = sobol(gpu::COVERAGE_PLACES * index + k) + middle;
    found.places[k] = glm::dvec2(quantile(used, u.x), quantile(used, u.y)) + moved;
    found.reach = std::max({found.reach, std::abs(found.places[k].x), std::abs(found.places[k].y)});
  }
  return found;
}

}  // namespace quadgraph
