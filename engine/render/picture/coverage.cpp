#include "engine/render/picture/coverage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "interface/display/coverage.comp.h"
#include "interface/display/silhouette.comp.h"

namespace quadgraph {
namespace {

// A triangle may cover all of a tile: so few that its rounds are not too many (coverage.comp).
constexpr std::uint32_t rows_at_once = 512;

// x of four places, then y of these, and so on.
using ByFours = std::array<float, std::size_t{2} * gpu::COVERAGE_PLACES>;

ByFours by_fours(const CoveragePlaces& places) {
  ByFours found{};
  for (std::size_t k = 0; k < places.places.size(); ++k) {
    found[8 * (k / 4) + k % 4] = places.places[k].x;
    found[8 * (k / 4) + 4 + k % 4] = places.places[k].y;
  }
  return found;
}

}  // namespace

void Coverage::make_room(std::uint32_t width, std::uint32_t height) {
  if (places_.size() == 0) places_ = {device_, sizeof(ByFours), device::Place::device, "picture/coverage"};
  const std::uint64_t marked = 4ull * gpu::silhouette_words(width) * height,
                      bytes = sizeof(gpu::PixelCoverage) * width * height + marked;
  if (pixels_.size() >= bytes && marked_bytes_ >= marked) return;
  marked_bytes_ = std::max(marked, marked_bytes_);
  pixels_ = {};
  pixels_ = {device_, bytes - marked + marked_bytes_, device::Place::device, "picture/coverage"};
}

void Coverage::record(device::Commands& commands, const gpu::TilePixels& tile, std::uint64_t scene, std::uint64_t seen,
                      std::uint32_t triangles, const CoveragePlaces& places) {
  if (!silhouette_) silhouette_.emplace(device_, shader::silhouette);
  if (!coverage_) coverage_.emplace(device_, shader::coverage);
  const ByFours fours = by_fours(places);
  commands.begin_pass("coverage");
  commands.update(places_, std::as_bytes(std::span(fours)));
  commands.fill(pixels_, 0);
  // Samples that differ lie within a quarter and five quarters of a pixel from the left of the first one's.
  commands.dispatch(*silhouette_,
                    gpu::SilhouettePush{.seen = seen,
                                        .marked = marked(),
                                        .tile = tile,
                                        .before = static_cast<std::uint32_t>(std::ceil(places.reach + 0.25)) - 1,
                                        .after = static_cast<std::uint32_t>(std::ceil(places.reach + 0.75)) - 1},
                    std::uint64_t{tile.width} * tile.height);
  for (std::uint32_t row = 0; row < tile.height; row += rows_at_once) {
    commands.dispatch(*coverage_,
                      gpu::CoveragePush{.scene = scene,
                                        .places = places_.address(),
                                        .marked = marked(),
                                        .coverage = covered(),
                                        .triangles = triangles,
                                        .tile = tile,
                                        .first_row = row,
                                        .row_count = std::min(rows_at_once, tile.height - row),
                                        .reach = places.reach},
                      triangles);
  }
  commands.end_pass();
}

}  // namespace quadgraph
