// A square of the target, which one thread draws.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/cpu/coverage.h"
#include "engine/cpu/triangles.h"

namespace quadgraph::cpu {

// Fragments of a tile to be shaded together.
class Batch {
 public:
  explicit Batch(const Frame& frame);

  bool has_room(const Triangle& t) const;
  void take(const Drawn& drawn, std::uint32_t pixel_of_tile, float z);

  // Shades them and writes colours; `texel`: of the tile's first pixel. Calls keep(pixel of the tile, z) for each that
  // is kept.
  template <typename Keep>
  void shade(std::uint64_t texel, const Keep& keep);

 private:
  static constexpr std::uint32_t fragments_at_once = 128;

  const Frame& frame_;
  bool derivatives_, front_ = true;
  std::uint32_t count_ = 0;
  std::array<std::uint32_t, fragments_at_once> pixels_;
  std::array<float, fragments_at_once> depths_;
  std::array<bool, fragments_at_once> kept_;
  std::vector<float> inputs_, right_, below_, colours_;
};

// Draws one tile after the other.
class Tile {
 public:
  explicit Tile(const Frame& frame);

  void draw(std::uint32_t number, const DrawMemory& memory);

 private:
  static constexpr std::uint32_t pixels = tile_side * tile_side;
  static constexpr std::uint32_t none = 0xffffffffu;

  // Calls each(triangle, as it is drawn, pixels that it may cover) for the triangles of the tile in their order.
  template <typename Each>
  void for_each(const DrawMemory& memory, const Each& each) const;

  Drawn drawn(const Triangle& t) const;
  void draw_depths(const DrawMemory& memory);
  void draw_seen(const DrawMemory& memory);
  void write_alike();
  void draw_in_order(const DrawMemory& memory);
  void leave_empty(std::uint32_t pixel_of_tile, std::uint32_t count) const;
  bool is_empty(const DrawMemory& memory) const;
  void clear(ImageMemory& target, float value) const;
  void write_depths();

  const Frame& frame_;
  ImageMemory& depth_;
  Batch batch_;
  const bool alike_;  // the fragment shader cannot tell the fragments of a triangle apart
  std::uint32_t number_ = 0, left_ = 0, top_ = 0, width_ = 0, height_ = 0;
  std::uint64_t texel_ = 0;  // the first
  alignas(16) std::array<float, pixels> depths_;
  alignas(16) std::array<std::uint32_t, pixels> seen_;  // by pixel: into drawn_, or none
  std::vector<Drawn> drawn_;
  std::vector<float> alike_colours_;  // by drawn_
};

}  // namespace quadgraph::cpu
