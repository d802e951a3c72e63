#include "engine/reference/sky.h"

#include "engine/file/geometry.h"
#include "engine/reference/exchange.h"

namespace quadgraph {
namespace {

std::vector<float> finer_sky(const Level& level, std::span<const float> coarse) {
  const Transfer& surface = level.surface;
  std::vector<float> sky(level.faces.size(), 0.0f);
  for (std::size_t k = 0; k < surface.index.size(); ++k) {
    sky[k / surface.width] += surface.weight[k] * coarse[surface.index[k]];
  }
  return sky;
}

std::vector<float> coarser_sky(const Level& level, const Level& coarse, std::span<const float> fine) {
  const Transfer& surface = level.surface;
  std::vector<double> sum(coarse.faces.size(), 0.0), weight(coarse.faces.size(), 0.0);
  for (std::size_t k = 0; k < surface.index.size(); ++k) {
    const std::size_t f = k / surface.width;
    const double share = face_area(level, level.faces[f]) * static_cast<double>(surface.weight[k]);
    sum[surface.index[k]] += share * static_cast<double>(fine[f]);
    weight[surface.index[k]] += share;
  }
  std::vector<float> sky(coarse.faces.size(), 1.0f);
  for (std::size_t f = 0; f < sky.size(); ++f) {
    if (weight[f] > 0) sky[f] = static_cast<float>(sum[f] / weight[f]);
  }
  return sky;
}

}  // namespace

std::vector<std::vector<float>> sky_of_levels(std::span<const Level> levels, std::uint32_t known,
                                              std::span<const float> sky) {
  std::vector<std::vector<float>> all(levels.size());
  all[known].assign(sky.begin(), sky.end());
  for (std::size_t i = known; i-- > 0;) all[i] = finer_sky(levels[i], all[i + 1]);
  for (std::size_t i = known + 1; i < levels.size(); ++i) all[i] = coarser_sky(levels[i - 1], levels[i], all[i - 1]);
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
