#include "engine/cpu/triangles.h"

#include <algorithm>
#include <cmath>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <numeric>

#include "engine/cpu/processor.h"

namespace quadgraph::cpu {
namespace {

constexpr std::uint32_t vertices_at_once = 256;    // of a call of the vertex shader
constexpr std::uint32_t triangles_at_once = 1024;  // that a thread takes
constexpr float guard_pixels = 32768;              // what lies further out is clipped
constexpr int planes = 6;
constexpr std::uint32_t behind_eye = 1u << planes;  // of Corner::outside

glm::vec4 position_of(const float* vertex) {
  return {vertex[0], vertex[1], vertex[2], vertex[3]};
}

glm::vec2 guard_of(const Frame& frame) {
  return {2 * guard_pixels / frame.viewport.width, 2 * guard_pixels / frame.viewport.height};
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

// Where a vertex in front of the eye comes to lie: in subpixels, and its depth, turned round where that falls.
Corner placed(const Frame& frame, const glm::vec4& p) {
  const device::Viewport& viewport = frame.viewport;
  const float inverse = 1 / p.w;
  const auto subpixel = [](double pixels) { return static_cast<std::int32_t>(std::lrint(pixel * pixels)); };
  return {.x = subpixel(viewport.x + 0.5 * (1 + double(p.x) * inverse) * viewport.width),
          .y = subpixel(viewport.y + 0.5 * (1 - double(p.y) * inverse) * viewport.height),
          .z = frame.pass.options.depth == device::Depth::falls ? -p.z * inverse : p.z * inverse,
          .inverse_w = inverse,
          .outside = 0};
}

Corner corner_of(const Frame& frame, const glm::vec4& p) {
  const glm::vec2 guard = guard_of(frame);
  std::uint32_t outside = p.w > 0 ? 0 : behind_eye;
  for (int plane = 0; plane < planes; ++plane) {
    if (!(inside(p, plane, guard) >= 0)) outside |= 1u << plane;
  }
  return outside == 0 ? placed(frame, p) : Corner{.x = 0, .y = 0, .z = 0, .inverse_w = 0, .outside = outside};
}

const float* between(Part& part, const float* a, const float* b, float t, std::uint32_t stride) {
  auto corner = std::make_unique_for_overwrite<float[]>(stride);
  for (std::uint32_t k = 0; k < stride; ++k) corner[k] = a[k] + t * (b[k] - a[k]);
  part.corners.push_back(std::move(corner));
  return part.corners.back().get();
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

// Whether no centre of a pixel lies between two places.
bool misses_centres(std::int32_t least, std::int32_t most) {
  return (least + pixel / 2 - 1) >> 8 > (most - pixel / 2) >> 8;
}

// Adds the triangle if it is turned to where it is seen and may cover a sample.
void add(Part& part, const Frame& frame, const float* first, const std::array<const float*, 3>& vertices,
         const std::array<const Corner*, 3>& corners) {
  const auto& [a, b, c] = corners;
  const std::int64_t twice = std::int64_t{b->x - a->x} * (c->y - a->y) - std::int64_t{c->x - a->x} * (b->y - a->y);
  const bool front = twice < 0;  // y is down
  const device::Cull cull = frame.pass.options.cull;
  if (twice == 0 || (cull == device::Cull::back && !front) || (cull == device::Cull::front && front)) return;
  if (misses_centres(std::min({a->x, b->x, c->x}), std::max({a->x, b->x, c->x}))) return;
  if (misses_centres(std::min({a->y, b->y, c->y}), std::max({a->y, b->y, c->y}))) return;
  Triangle& t = part.triangles.emplace_back();
  t.flat = first + position_floats;
  t.front = front;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t from = front || k == 0 ? k : 3 - k;
    t.x[k] = corners[from]->x;
    t.y[k] = corners[from]->y;
    t.z[k] = corners[from]->z;
    t.inverse_w[k] = corners[from]->inverse_w;
    t.values[k] = vertices[from] + position_floats;
  }
}

void add_clipped(Part& part, const Frame& frame, const std::array<const float*, 3>& vertices) {
  std::vector<const float*> polygon(vertices.begin(), vertices.end());
  for (int plane = 0; plane < planes && !polygon.empty(); ++plane) {
    polygon = clipped(part, polygon, plane, guard_of(frame), frame.stride);
  }
  std::vector<Corner> corners;
  for (const float* vertex : polygon) {
    if (!(vertex[3] > 0)) return;
    corners.push_back(placed(frame, position_of(vertex)));
  }
  for (std::size_t k = 2; k < polygon.size(); ++k) {
    add(part, frame, vertices[0], {polygon[0], polygon[k - 1], polygon[k]},
        {&corners[0], &corners[k - 1], &corners[k]});
  }
}

// Columns or rows of tiles that a triangle may touch.
struct Tiles {
  std::int32_t first, last;

  Tiles(const std::array<std::int32_t, 3>& at, std::uint32_t count) {
    constexpr std::int32_t side = pixel * static_cast<std::int32_t>(tile_side);
    first = std::max(std::min({at[0], at[1], at[2]}), 0) / side;
    const std::int32_t most = std::max({at[0], at[1], at[2]});
    last = most < 0 ? -1 : std::min(most / side, static_cast<std::int32_t>(count) - 1);
  }
};

template <typename Each>
void for_each_tile(const Frame& frame, const Triangle& t, const Each& each) {
  const Tiles columns(t.x, frame.columns()), rows(t.y, frame.rows());
  for (std::int32_t y = rows.first; y <= rows.last; ++y) {
    for (std::int32_t x = columns.first; x <= columns.last; ++x) {
      each(static_cast<std::size_t>(y) * frame.columns() + static_cast<std::size_t>(x));
    }
  }
}

void sort_by_tile(const Frame& frame, Part& part) {
  const std::size_t tiles = std::size_t{frame.columns()} * frame.rows();
  part.first.assign(tiles + 1, 0);
  for (const Triangle& t : part.triangles) {
    for_each_tile(frame, t, [&](std::size_t tile) { ++part.first[tile]; });
  }
  // Where a tile's list ends; its triangles are then put before that, the last one first.
  std::inclusive_scan(part.first.begin(), part.first.end(), part.first.begin());
  part.of_tile.resize(part.first[tiles]);
  for (std::uint32_t k = static_cast<std::uint32_t>(part.triangles.size()); k-- > 0;) {
    for_each_tile(frame, part.triangles[k], [&](std::size_t tile) { part.of_tile[--part.first[tile]] = k; });
  }
}

void run_vertices(Processor& processor, const Frame& frame, std::uint32_t count) {
  DrawMemory& memory = processor.draw_memory();
  if (memory.vertices.size() < std::size_t{count} * frame.stride) {
    memory.vertices = std::vector<float>(std::size_t{count} * frame.stride);
  }
  if (memory.corners.size() < count) memory.corners = std::vector<Corner>(count);
  processor.run(count, vertices_at_once, [&](std::uint32_t begin, std::uint32_t end) {
    std::array<std::uint32_t, vertices_at_once> numbers;
    for (std::uint32_t first = begin; first < end; first += vertices_at_once) {
      const std::uint32_t some = std::min(end - first, vertices_at_once);
      std::iota(numbers.begin(), numbers.begin() + some, first);
      float* results = memory.vertices.data() + std::size_t{first} * frame.stride;
      frame.pass.vertex(frame.push, numbers.data(), some, results, frame.pass.options.variant);
      for (std::uint32_t k = 0; k < some; ++k) {
        memory.corners[first + k] = corner_of(frame, position_of(results + std::size_t{k} * frame.stride));
      }
    }
  });
}

// Triangles `begin` to `end`.
void set_up_part(const Frame& frame, const std::uint32_t* indices, std::uint32_t begin, std::uint32_t end,
                 const DrawMemory& memory, Part& part) {
  part.triangles.clear();
  part.corners.clear();
  for (std::uint32_t t = begin; t < end; ++t) {
    std::array<const float*, 3> vertices;
    std::array<const Corner*, 3> corners;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t vertex = indices == nullptr ? 3 * t + k : indices[3 * t + k];
      vertices[k] = memory.vertices.data() + std::size_t{vertex} * frame.stride;
      corners[k] = &memory.corners[vertex];
    }
    const std::uint32_t some = corners[0]->outside | corners[1]->outside | corners[2]->outside;
    const std::uint32_t all = corners[0]->outside & corners[1]->outside & corners[2]->outside;
    if (some == 0) {
      add(part, frame, vertices[0], vertices, corners);
    } else if ((all & ~behind_eye) == 0 && some != behind_eye) {
      add_clipped(part, frame, vertices);
    }
  }
  sort_by_tile(frame, part);
}

}  // namespace

void set_up(Processor& processor, const Frame& frame, const std::uint32_t* indices, std::uint32_t vertices) {
  DrawMemory& memory = processor.draw_memory();
  const std::uint32_t triangles = vertices / 3;
  memory.part_count = (triangles + triangles_at_once - 1) / triangles_at_once;
  if (memory.parts.size() < memory.part_count) memory.parts.resize(memory.part_count);
  if (triangles == 0) return;
  const auto greater = [](std::uint32_t a, std::uint32_t b) { return std::max(a, b); };
  const std::uint32_t count = indices == nullptr ? vertices : std::reduce(indices, indices + vertices, 0u, greater) + 1;
  run_vertices(processor, frame, count);
  processor.run(memory.part_count, 1, [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t p = begin; p < end; ++p) {
      const std::uint32_t last = std::min((p + 1) * triangles_at_once, triangles);
      set_up_part(frame, indices, p * triangles_at_once, last, memory, memory.parts[p]);
    }
  });
}

}  // namespace quadgraph::cpu
