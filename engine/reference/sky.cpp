#include "engine/reference/sky.h"

#include "engine/file/geometry.h"
#include "engine/reference/exchange.h"

namespace quadgraph {
namespace {

std::vector<float> applied(const SkyRows& rows, std::span<const float> from) {
  std::vector<float> sky(rows.offset.size() - 1, 1.0f);
  for (std::size_t f = 0; f < sky.size(); ++f) {
    if (rows.offset[f] == rows.offset[f + 1]) continue;
    sky[f] = 0;
    for (std::uint32_t k = rows.offset[f]; k < rows.offset[f + 1]; ++k) sky[f] += rows.weight[k] * from[rows.index[k]];
  }
  return sky;
}

}  // namespace

SkyRows finer_sky_rows(const Level& level) {
  const Transfer& surface = level.surface;
  SkyRows rows{{}, {surface.index.begin(), surface.index.end()}, {surface.weight.begin(), surface.weight.end()}};
  for (std::uint32_t f = 0; f <= level.faces.size(); ++f) rows.offset.push_back(f * surface.width);
  return rows;
}

SkyRows coarser_sky_rows(const Level& level, const Level& coarse) {
  const Transfer& surface = level.surface;
  struct Entry {
    std::uint32_t face;
    double share;
  };
  std::vector<std::vector<Entry>> taken(coarse.faces.size());
  for (std::size_t k = 0; k < surface.index.size(); ++k) {
    const auto f = static_cast<std::uint32_t>(k / surface.width);
    const double share = face_area(level, level.faces[f]) * static_cast<double>(surface.weight[k]);
    if (share > 0) taken[surface.index[k]].push_back({f, share});
  }
  SkyRows rows{{0}, {}, {}};
  for (const std::vector<Entry>& entries : taken) {
    double whole = 0;
    for (const Entry& entry : entries) whole += entry.share;
    for (const Entry& entry : entries) {
      rows.index.push_back(entry.face);
      rows.weight.push_back(static_cast<float>(entry.share / whole));
    }
    rows.offset.push_back(static_cast<std::uint32_t>(rows.index.size()));
  }
  return rows;
}

std::vector<std::vector<float>> sky_of_levels(std::span<const Level> levels, std::uint32_t known,
                                              std::span<const float> sky) {
  std::vector<std::vector<float>> all(levels.size());
  all[known].assign(sky.begin(), sky.end());
  for (std::size_t i = known; i-- > 0;) all[i] = applied(finer_sky_rows(levels[i]), all[i + 1]);
  for (std::size_t i = known + 1; i < levels.size(); ++i) {
    all[i] = applied(coarser_sky_rows(levels[i - 1], levels[i]), all[i - 1]);
  }
  return all;
}

std::vector<std::vector<float>> sky_of_levels(std::span<const Level> levels) {
  for (std::uint32_t i = 0; i < levels.size(); ++i) {
    if (levels[i].seen.empty()) continue;
    const std::vector<double> sky = sky_visibility(levels[i]);
    return sky_of_levels(levels, i, std::vector<float>(sky.begin(), sky.end()));
  }
  std::vector<std::vector<float>> all;
  for (const Level& level : levels) all.emplace_back(level.faces.size(), 1.0f);
  return all;
}

}  // namespace quadgraph
