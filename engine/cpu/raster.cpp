#include "engine/cpu/raster.h"

#include <algorithm>
#include <array>
#include <vector>

#include "engine/cpu/tile.h"
#include "engine/cpu/triangles.h"

namespace quadgraph::cpu {
namespace {

// Columns or rows of tiles that a triangle may touch.
struct Tiles {
  std::int64_t first, last;

  Tiles(const std::array<std::int32_t, 3>& at, std::uint32_t count) {
    constexpr std::int64_t side = pixel * tile_side;
    const auto [least, most] = std::minmax({at[0], at[1], at[2]});
    first = least < 0 ? 0 : least / side;
    last = most < 0 ? -1 : std::min<std::int64_t>(most / side, std::int64_t{count} - 1);
  }
};

// Triangles by tile, in their order: one list after the other.
class Bins {
 public:
  Bins(const device::DrawImages& target, const std::vector<Part>& parts)
      : columns_((target.width + tile_side - 1) / tile_side), rows_((target.height + tile_side - 1) / tile_side) {
    std::vector<std::size_t> next(std::size_t{tiles()} + 1, 0);
    for_each(parts, [&](std::size_t tile, const Triangle&) { ++next[tile + 1]; });
    for (std::size_t tile = 0; tile < tiles(); ++tile) next[tile + 1] += next[tile];
    offset_ = next;
    triangle_.resize(offset_.back());
    for_each(parts, [&](std::size_t tile, const Triangle& t) { triangle_[next[tile]++] = &t; });
  }

  std::uint32_t columns() const { return columns_; }
  std::uint32_t tiles() const { return columns_ * rows_; }

  template <typename Draw>
  void draw(std::uint32_t tile, const Draw& draw) const {
    for (std::size_t k = offset_[tile]; k < offset_[tile + 1]; ++k) draw(*triangle_[k]);
  }

 private:
  template <typename Add>
  void for_each(const std::vector<Part>& parts, const Add& add) const {
    for (const Part& part : parts) {
      for (const Triangle& t : part.triangles) {
        const Tiles across(t.x, columns_), down(t.y, rows_);
        for (std::int64_t y = down.first; y <= down.last; ++y) {
          for (std::int64_t x = across.first; x <= across.last; ++x) add(static_cast<std::size_t>(y * columns_ + x), t);
        }
      }
    }
  }

  std::uint32_t columns_, rows_;
  std::vector<std::size_t> offset_;
  std::vector<const Triangle*> triangle_;
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
  threads.run(bins.tiles(), 1, [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t k = begin; k < end; ++k) {
      Tile tile(frame, k % bins.columns() * tile_side, k / bins.columns() * tile_side);
      tile.clear();
      bins.draw(k, [&](const Triangle& t) { tile.draw(t); });
      tile.finish();
    }
  });
}

}  // namespace quadgraph::cpu
