#include "engine/cpu/triangles.h"

#include <algorithm>
#include <cmath>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <numeric>

namespace quadgraph::cpu {
namespace {

constexpr std::uint32_t vertices_at_once = 256;    // of a call of the vertex shader
constexpr std::uint32_t triangles_at_once = 1024;  // that a thread takes
constexpr float guard_pixels = 32768;              // what lies further out is clipped

glm::vec4 position_of(const float* vertex) {
  return {vertex[0], vertex[1], vertex[2], vertex[3]};
}

// How far inside of one of the clip planes: near, far, and the four of the guard band.
float inside(const glm::vec4& p, int plane, const glm::vec2& guard) {
  switch (plane) {
    case 0:
      return p.z;
    case 1:
      return p.w - p.z;
    case 2:
      return guard.x * p.w + p.x;
    case 3:
      return guard.x * p.w - p.x;
    case 4:
      return guard.y * p.w + p.y;
    default:
      return guard.y * p.w - p.y;
  }
}

constexpr int planes = 6;

const float* between(Part& part, const float* a, const float* b, float t, std::uint32_t stride) {
  auto corner = std::make_unique<std::vector<float>>(stride);
  for (std::uint32_t k = 0; k < stride; ++k) (*corner)[k] = a[k] + t * (b[k] - a[k]);
  part.corners.push_back(std::move(corner));
  return part.corners.back()->data();
}

// Sutherland and Hodgman: what of a convex polygon lies inside of a plane.
std::vector<const float*> clipped(Part& part, const std::vector<const float*>& polygon, int plane,
                                  const glm::vec2& guard, std::uint32_t stride) {
  std::vector<const float*> left;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const float* a = polygon[k];
    const float* b = polygon[(k + 1) % polygon.size()];
    const float at_a = inside(position_of(a), plane, guard), at_b = inside(position_of(b), plane, guard);
    if (at_a >= 0) left.push_back(a);
    if ((at_a >= 0) != (at_b >= 0)) left.push_back(between(part, a, b, at_a / (at_a - at_b), stride));
  }
  return left;
}

// In subpixels; the guard band keeps it within 2^24.
std::int32_t rounded(double pixels) {
  return static_cast<std::int32_t>(std::lrint(subpixels * pixels));
}

// Adds the triangle if it is turned to where it is seen; all corners in front of the eye.
void add(Part& part, const Frame& frame, const float* first, std::array<const float*, 3> corners) {
  Triangle t;
  t.flat = first + position_floats;
  for (int k = 0; k < 3; ++k) {
    const glm::vec4 p = position_of(corners[k]);
    const float inverse = 1 / p.w;
    t.x[k] = rounded(frame.viewport.x + 0.5 * (1 + double(p.x) * inverse) * frame.viewport.width);
    t.y[k] = rounded(frame.viewport.y + 0.5 * (1 - double(p.y) * inverse) * frame.viewport.height);
    t.z[k] = p.z * inverse;
    t.inverse_w[k] = inverse;
    t.values[k] = corners[k] + position_floats;
  }
  const std::int64_t twice =
      std::int64_t{t.x[1] - t.x[0]} * (t.y[2] - t.y[0]) - std::int64_t{t.x[2] - t.x[0]} * (t.y[1] - t.y[0]);
  const bool front = twice < 0;  // y is down
  const device::Cull cull = frame.pass.options.cull;
  if (twice == 0 || (cull == device::Cull::back && !front) || (cull == device::Cull::front && front)) return;
  t.front = front;
  if (!front) {
    std::swap(t.x[1], t.x[2]);
    std::swap(t.y[1], t.y[2]);
    std::swap(t.z[1], t.z[2]);
    std::swap(t.inverse_w[1], t.inverse_w[2]);
    std::swap(t.values[1], t.values[2]);
  }
  part.triangles.push_back(t);
}

void add_clipped(Part& part, const Frame& frame, const std::array<const float*, 3>& corners) {
  const glm::vec2 guard(2 * guard_pixels / frame.viewport.width, 2 * guard_pixels / frame.viewport.height);
  bool whole = true;
  for (int plane = 0; plane < planes; ++plane) {
    int in = 0;
    for (const float* corner : corners) in += inside(position_of(corner), plane, guard) >= 0 ? 1 : 0;
    if (in == 0) return;
    whole = whole && in == 3;
  }
  if (whole) {
    if (position_of(corners[0]).w > 0 && position_of(corners[1]).w > 0 && position_of(corners[2]).w > 0) {
      add(part, frame, corners[0], corners);
    }
    return;
  }
  std::vector<const float*> polygon(corners.begin(), corners.end());
  for (int plane = 0; plane < planes && !polygon.empty(); ++plane) {
    polygon = clipped(part, polygon, plane, guard, frame.stride);
  }
  for (const float* corner : polygon) {
    if (!(position_of(corner).w > 0)) return;
  }
  for (std::size_t k = 2; k < polygon.size(); ++k)
    add(part, frame, corners[0], {polygon[0], polygon[k - 1], polygon[k]});
}

}  // namespace

std::vector<float> run_vertices(ThreadPool& threads, const Frame& frame, const std::uint32_t* indices,
                                std::uint32_t vertices) {
  const std::uint32_t count = indices == nullptr ? vertices : *std::max_element(indices, indices + vertices) + 1;
  std::vector<float> results(std::size_t{count} * frame.stride);
  threads.run(count, vertices_at_once, [&](std::uint32_t begin, std::uint32_t end) {
    std::array<std::uint32_t, vertices_at_once> numbers;
    for (std::uint32_t first = begin; first < end; first += vertices_at_once) {
      const std::uint32_t some = std::min(end - first, vertices_at_once);
      std::iota(numbers.begin(), numbers.begin() + some, first);
      frame.pass.vertex(frame.push, numbers.data(), some, results.data() + std::size_t{first} * frame.stride,
                        frame.pass.options.variant);
    }
  });
  return results;
}

std::vector<Part> set_up(ThreadPool& threads, const Frame& frame, const std::vector<float>& results,
                         const std::uint32_t* indices, std::uint32_t triangles) {
  std::vector<Part> parts((triangles + triangles_at_once - 1) / triangles_at_once);
  const auto vertex = [&](std::uint32_t k) {
    return results.data() + std::size_t{indices == nullptr ? k : indices[k]} * frame.stride;
  };
  threads.run(static_cast<std::uint32_t>(parts.size()), 1, [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t p = begin; p < end; ++p) {
      parts[p].triangles.reserve(triangles_at_once);
      const std::uint32_t last = std::min((p + 1) * triangles_at_once, triangles);
      for (std::uint32_t t = p * triangles_at_once; t < last; ++t) {
        add_clipped(parts[p], frame, {vertex(3 * t), vertex(3 * t + 1), vertex(3 * t + 2)});
      }
    }
  });
  return parts;
}

}  // namespace quadgraph::cpu
