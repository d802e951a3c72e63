#include "engine/cpu/raster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <numeric>
#include <vector>

namespace quadgraph::cpu {
namespace {

constexpr std::uint32_t tile_side = 64;            // pixels
constexpr std::uint32_t vertices_at_once = 256;    // of a call of the vertex shader
constexpr std::uint32_t triangles_at_once = 1024;  // that a thread takes
constexpr std::uint32_t position_floats = 4;       // before a vertex's own values
constexpr double subpixels = 256;                  // positions are rounded to this part of a pixel
constexpr std::int64_t pixel = 256;                // in subpixels
constexpr float guard_pixels = 32768;              // what lies further out is clipped

// A corner of a triangle: clip coordinates and the values of the vertex shader.
using Values = std::vector<float>;

// A triangle in the window, counter-clockwise: subpixels from the upper left with y down.
struct Triangle {
  std::array<std::int64_t, 3> x, y;
  std::array<float, 3> z, inverse_w;
  std::array<const float*, 3> values;  // per location four floats
  const float* flat;                   // those of the first corner, also where it was clipped away
  bool front;
};

struct Frame {
  const device::DrawImages& target;
  const device::Viewport& viewport;
  const GraphicsPipeline& pass;
  const void* push;
  std::uint32_t stride;  // floats of a vertex with its position

  std::uint32_t floats() const { return stride - position_floats; }
};

// Triangles of some that follow each other, in their order, and the corners that clipping has made.
struct Part {
  std::vector<Triangle> triangles;
  std::vector<std::unique_ptr<Values>> corners;
};

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
  auto corner = std::make_unique<Values>(stride);
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

// Adds the triangle if it is turned to where it is seen; all corners in front of the eye.
void add(Part& part, const Frame& frame, const float* first, std::array<const float*, 3> corners) {
  Triangle t;
  t.flat = first + position_floats;
  for (int k = 0; k < 3; ++k) {
    const glm::vec4 p = position_of(corners[k]);
    const float inverse = 1 / p.w;
    t.x[k] = std::llrint(subpixels * (frame.viewport.x + 0.5 * (1 + double(p.x) * inverse) * frame.viewport.width));
    t.y[k] = std::llrint(subpixels * (frame.viewport.y + 0.5 * (1 - double(p.y) * inverse) * frame.viewport.height));
    t.z[k] = p.z * inverse;
    t.inverse_w[k] = inverse;
    t.values[k] = corners[k] + position_floats;
  }
  const std::int64_t twice = (t.x[1] - t.x[0]) * (t.y[2] - t.y[0]) - (t.x[2] - t.x[0]) * (t.y[1] - t.y[0]);
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

// An edge of a triangle: above 0 inside, 0 on it; it changes by the steps from pixel to pixel.
struct Edge {
  std::int64_t dx, dy, at;  // `at` the centre of the first pixel
  std::int64_t least;       // that is in: 0 for top and left edges, else 1

  Edge(const Triangle& t, int from, int to, std::int64_t first_x, std::int64_t first_y)
      : dx(t.x[to] - t.x[from]), dy(t.y[to] - t.y[from]) {
    at = dy * (first_x - t.x[from]) - dx * (first_y - t.y[from]);
    least = (dy > 0 || (dy == 0 && dx < 0)) ? 0 : 1;
  }
};

// Values of one fragment: `b` are weights in the window, which add up to 1.
void interpolate(const Triangle& t, const std::array<double, 3>& b, std::uint32_t floats, std::uint32_t flat,
                 float* result) {
  std::array<float, 3> weight;
  double sum = 0;
  for (int k = 0; k < 3; ++k) sum += b[k] * t.inverse_w[k];
  for (int k = 0; k < 3; ++k) weight[k] = static_cast<float>(b[k] * t.inverse_w[k] / sum);
  for (std::uint32_t k = 0; k < floats; ++k) {
    result[k] = (flat >> (k / 4) & 1u) != 0
                    ? t.flat[k]
                    : weight[0] * t.values[0][k] + weight[1] * t.values[1][k] + weight[2] * t.values[2][k];
  }
}

// Fragments of one triangle in one tile, to be shaded together.
class Batch {
 public:
  explicit Batch(const Frame& frame) : frame_(frame) {}

  void clear() {
    pixels_.clear();
    for (std::vector<float>* values : {&inputs_, &right_, &below_}) values->clear();
  }

  void take(const Triangle& t, std::uint64_t at, const std::array<double, 3>& b, const std::array<double, 3>& step_x,
            const std::array<double, 3>& step_y) {
    const std::uint32_t floats = frame_.floats(), flat = frame_.pass.options.vertex->flat;
    const std::size_t end = inputs_.size();
    pixels_.push_back(at);
    inputs_.resize(end + floats);
    interpolate(t, b, floats, flat, inputs_.data() + end);
    if (!frame_.pass.options.fragment->derivatives) return;
    right_.resize(end + floats);
    below_.resize(end + floats);
    const std::array<double, 3> right{b[0] + step_x[0], b[1] + step_x[1], b[2] + step_x[2]};
    const std::array<double, 3> below{b[0] + step_y[0], b[1] + step_y[1], b[2] + step_y[2]};
    interpolate(t, right, floats, flat, right_.data() + end);
    interpolate(t, below, floats, flat, below_.data() + end);
  }

  // Shades them and writes colours; `keep(k)` for each that is kept.
  template <typename Keep>
  void shade(bool front, const Keep& keep) {
    const auto count = static_cast<std::uint32_t>(pixels_.size());
    if (count == 0) return;
    const std::size_t images = frame_.target.colours.size();
    colours_.resize(4 * images * count);
    if (kept_.size() < count) kept_ = std::vector<char>(count);
    frame_.pass.fragment(frame_.push, front, inputs_.data(), right_.data(), below_.data(), count, colours_.data(),
                         reinterpret_cast<bool*>(kept_.data()), frame_.pass.options.variant);
    for (std::uint32_t k = 0; k < count; ++k) {
      if (kept_[k] == 0) continue;
      for (std::size_t image = 0; image < images; ++image) {
        auto& memory = static_cast<ImageMemory&>(*frame_.target.colours[image]);
        std::copy_n(colours_.data() + 4 * (images * k + image), 4, memory.texels() + 4 * pixels_[k]);
      }
      keep(k);
    }
  }

  std::uint64_t pixel_of(std::uint32_t k) const { return pixels_[k]; }

 private:
  const Frame& frame_;
  std::vector<std::uint64_t> pixels_;
  std::vector<float> inputs_, right_, below_, colours_;
  std::vector<char> kept_;
};

// A square of the target; a thread draws all of it.
class Tile {
 public:
  Tile(const Frame& frame, std::uint32_t x, std::uint32_t y)
      : frame_(frame),
        depth_(static_cast<ImageMemory&>(*frame.target.depth)),
        batch_(frame),
        left_(x),
        top_(y),
        right_(std::min(x + tile_side, frame.target.width)),
        bottom_(std::min(y + tile_side, frame.target.height)) {}

  void clear() {
    for (std::uint32_t y = top_; y < bottom_; ++y) {
      std::fill_n(depth_.texels() + at(left_, y), right_ - left_, 1.0f);
      for (device::ImageMemory* image : frame_.target.colours) {
        std::fill_n(static_cast<ImageMemory&>(*image).texels() + 4 * at(left_, y), 4 * (right_ - left_), 0.0f);
      }
    }
  }

  void draw(const Triangle& t) {
    const std::int64_t x0 = std::max<std::int64_t>(left_, first_pixel(*std::min_element(t.x.begin(), t.x.end())));
    const std::int64_t y0 = std::max<std::int64_t>(top_, first_pixel(*std::min_element(t.y.begin(), t.y.end())));
    const std::int64_t x1 = std::min<std::int64_t>(right_, last_pixel(*std::max_element(t.x.begin(), t.x.end())) + 1);
    const std::int64_t y1 = std::min<std::int64_t>(bottom_, last_pixel(*std::max_element(t.y.begin(), t.y.end())) + 1);
    if (x0 >= x1 || y0 >= y1) return;
    const std::int64_t cx = x0 * pixel + pixel / 2, cy = y0 * pixel + pixel / 2;
    std::array<Edge, 3> edge = {Edge(t, 1, 2, cx, cy), Edge(t, 2, 0, cx, cy), Edge(t, 0, 1, cx, cy)};
    const double inverse =
        1.0 / static_cast<double>((t.x[2] - t.x[0]) * (t.y[1] - t.y[0]) - (t.x[1] - t.x[0]) * (t.y[2] - t.y[0]));
    std::array<double, 3> step_x, step_y;
    for (int k = 0; k < 3; ++k) {
      step_x[k] = inverse * static_cast<double>(edge[k].dy * pixel);
      step_y[k] = -inverse * static_cast<double>(edge[k].dx * pixel);
    }
    batch_.clear();
    for (std::int64_t y = y0; y < y1; ++y) {
      std::array<std::int64_t, 3> e = {edge[0].at, edge[1].at, edge[2].at};
      for (std::int64_t x = x0; x < x1; ++x) {
        if (e[0] >= edge[0].least && e[1] >= edge[1].least && e[2] >= edge[2].least) {
          const std::array<double, 3> b = {inverse * static_cast<double>(e[0]), inverse * static_cast<double>(e[1]),
                                           inverse * static_cast<double>(e[2])};
          take(t, at(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)), b, step_x, step_y);
        }
        for (int k = 0; k < 3; ++k) e[k] += edge[k].dy * pixel;
      }
      for (Edge& one : edge) one.at -= one.dx * pixel;
    }
    if (frame_.pass.fragment == nullptr) return;
    batch_.shade(t.front, [&](std::uint32_t k) { depth_.texels()[batch_.pixel_of(k)] = depths_[k]; });
    depths_.clear();
  }

 private:
  static std::int64_t first_pixel(std::int64_t at) { return (at - pixel / 2 + pixel - 1) >> 8; }
  static std::int64_t last_pixel(std::int64_t at) { return (at - pixel / 2) >> 8; }

  std::uint64_t at(std::uint32_t x, std::uint32_t y) const { return std::uint64_t{y} * depth_.options.width + x; }

  void take(const Triangle& t, std::uint64_t place, const std::array<double, 3>& b, const std::array<double, 3>& step_x,
            const std::array<double, 3>& step_y) {
    const auto z = static_cast<float>(b[0] * t.z[0] + b[1] * t.z[1] + b[2] * t.z[2]);
    if (!(z < depth_.texels()[place])) return;
    if (frame_.pass.fragment == nullptr) {
      depth_.texels()[place] = z;
      return;
    }
    batch_.take(t, place, b, step_x, step_y);
    depths_.push_back(z);
  }

  const Frame& frame_;
  ImageMemory& depth_;
  Batch batch_;
  std::vector<float> depths_;  // of the batch
  std::uint32_t left_, top_, right_, bottom_;
};

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
      const std::uint32_t last = std::min((p + 1) * triangles_at_once, triangles);
      for (std::uint32_t t = p * triangles_at_once; t < last; ++t) {
        add_clipped(parts[p], frame, {vertex(3 * t), vertex(3 * t + 1), vertex(3 * t + 2)});
      }
    }
  });
  return parts;
}

// Triangles by tile, in their order.
struct Bins {
  std::uint32_t columns, rows;
  std::vector<std::vector<const Triangle*>> tiles;

  Bins(const device::DrawImages& target, const std::vector<Part>& parts)
      : columns((target.width + tile_side - 1) / tile_side),
        rows((target.height + tile_side - 1) / tile_side),
        tiles(std::size_t{columns} * rows) {
    for (const Part& part : parts) {
      for (const Triangle& t : part.triangles) add(t);
    }
  }

  void add(const Triangle& t) {
    const auto [left, right] = tiles_of(t.x, columns);
    const auto [top, bottom] = tiles_of(t.y, rows);
    for (std::int64_t y = top; y <= bottom; ++y) {
      for (std::int64_t x = left; x <= right; ++x) tiles[static_cast<std::size_t>(y * columns + x)].push_back(&t);
    }
  }

  static std::pair<std::int64_t, std::int64_t> tiles_of(const std::array<std::int64_t, 3>& at, std::uint32_t count) {
    const auto [least, most] = std::minmax_element(at.begin(), at.end());
    constexpr std::int64_t side = pixel * tile_side;
    const std::int64_t first = std::max<std::int64_t>(*least < 0 ? 0 : *least / side, 0);
    const std::int64_t last = *most < 0 ? -1 : std::min<std::int64_t>(*most / side, std::int64_t{count} - 1);
    return {first, last};
  }
};

}  // namespace

void rasterise(ThreadPool& threads, const device::DrawImages& target, const device::Viewport& viewport,
               const GraphicsPipeline& pass, const void* push, const std::uint32_t* indices, std::uint32_t vertices) {
  const Frame frame{target, viewport, pass, push, position_floats + 4 * pass.options.vertex->locations};
  std::vector<float> results;
  std::vector<Part> parts;
  if (vertices >= 3) {
    results = run_vertices(threads, frame, indices, vertices);
    parts = set_up(threads, frame, results, indices, vertices / 3);
  }
  const Bins bins(target, parts);
  threads.run(static_cast<std::uint32_t>(bins.tiles.size()), 1, [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t k = begin; k < end; ++k) {
      Tile tile(frame, k % bins.columns * tile_side, k / bins.columns * tile_side);
      tile.clear();
      for (const Triangle* t : bins.tiles[k]) tile.draw(*t);
    }
  });
}

}  // namespace quadgraph::cpu
