// A square of the target of a draw, which one thread draws all of.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/cpu/triangles.h"

namespace quadgraph::cpu {

constexpr std::uint32_t tile_side = 64;  // pixels

// The weights of a triangle's corners anywhere in the window. Edge k, opposite corner k: above 0 inside, 0 on it.
class Edges {
 public:
  Edges() = default;
  explicit Edges(const Triangle& t);

  std::int64_t at(int k, std::int64_t x, std::int64_t y) const { return dy_[k] * (x - x_[k]) - dx_[k] * (y - y_[k]); }
  std::int64_t to_right(int k) const { return dy_[k] * pixel; }
  std::int64_t to_below(int k) const { return -dx_[k] * pixel; }
  std::int64_t least(int k) const { return least_[k]; }  // that is in: 0 for top and left edges, else 1
  double inverse() const { return 1.0 / static_cast<double>(twice_); }

 private:
  std::array<std::int64_t, 3> x_, y_, dx_, dy_, least_;  // subpixels
  std::int64_t twice_;                                   // twice the area
};

// Fragments to be shaded together, all of them of triangles that face the eye, or none.
class Batch {
 public:
  Batch(const Frame& frame, bool front) : frame_(frame), front_(front) {}

  std::uint32_t count() const { return static_cast<std::uint32_t>(pixels_.size()); }
  std::uint64_t pixel_of(std::uint32_t k) const { return pixels_[k]; }
  void take(const Triangle& t, const Edges& edges, std::uint64_t place, const std::array<double, 3>& weights);

  // Shades them and writes colours; `keep(k)` for each that is kept. None is left.
  template <typename Keep>
  void shade(const Keep& keep);

 private:
  const Frame& frame_;
  bool front_;
  std::vector<std::uint64_t> pixels_;
  std::vector<float> inputs_, right_, below_, colours_;
  std::vector<char> kept_;
};

class Tile {
 public:
  Tile(const Frame& frame, std::uint32_t x, std::uint32_t y);

  void clear();
  void draw(const Triangle& t);
  void finish();  // after the last triangle

 private:
  std::uint64_t place(std::uint32_t x, std::uint32_t y) const { return std::uint64_t{y} * depth_.options.width + x; }
  void cover(const Triangle& t, const Edges& edges, std::int64_t x, std::int64_t y,
             const std::array<double, 3>& weights);

  const Frame& frame_;
  ImageMemory& depth_;
  std::uint32_t left_, top_, right_, bottom_;
  // Where no fragment is discarded, shading waits until it is known which triangle is seen.
  bool waits_;
  std::array<const Triangle*, tile_side * tile_side> seen_;
  Batch front_, back_;
  std::vector<float> depths_;  // of the batch, where shading does not wait
};

}  // namespace quadgraph::cpu
