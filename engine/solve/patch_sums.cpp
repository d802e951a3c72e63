#include "engine/solve/patch_sums.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace quadgraph {
namespace {

constexpr double most_noise = 0.3;  // of the power of a part of which anything is said

// Mean and its standard error.
template <typename Values>
std::pair<double, double> mean_of(const Values& values) {
  const double count = static_cast<double>(values.size());
  double mean = 0, squares = 0;
  for (const double value : values) mean += value / count;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return {mean, std::sqrt(squares / (count * (count - 1)))};
}

// Of the batches but one, or of all: the products of what different ones differ from the solution by, which the noise
// of neither is in, over patches; relative to the light of the walks.
double relative_square(const PatchSums& part, std::size_t without) {
  double products = 0, size = 0;
  for (const PatchSums::Patch& patch : part.patches) {
    if (patch.area == 0) continue;
    glm::dvec3 difference{0}, walked{0};
    double own = 0, count = 0;
    for (std::size_t b = 0; b < patch.walked.size(); ++b) {
      if (b == without) continue;
      const glm::dvec3 d = patch.solved - patch.walked[b];
      difference += d;
      walked += patch.walked[b];
      own += glm::dot(d, d);
      ++count;
    }
    products += (glm::dot(difference, difference) - own) / (count * (count - 1)) / patch.area;
    size += glm::dot(walked, walked) / (count * count) / patch.area;
  }
  return size > 0 ? products / size : 0;
}

}  // namespace

double sum_of_channels(const glm::dvec3& v) {
  return v.x + v.y + v.z;
}

std::vector<bool> dimmest_patches(const PatchSums& whole) {
  std::vector<std::size_t> order;
  double left = 0;
  for (std::size_t k = 0; k < whole.patches.size(); ++k) {
    if (whole.patches[k].area == 0) continue;
    order.push_back(k);
    left += whole.patches[k].area / 3;
  }
  const auto bright = [&](std::size_t k) { return sum_of_channels(whole.patches[k].solved) / whole.patches[k].area; };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return bright(a) < bright(b); });
  std::vector<bool> taken(whole.patches.size());
  for (const std::size_t k : order) {
    left -= whole.patches[k].area;
    taken[k] = true;
    if (left <= 0) break;
  }
  return taken;
}

CertifiedPart certified(const PatchSums& part) {
  std::array<double, walk_batches> walked{};
  double solved = 0;
  for (const PatchSums::Patch& patch : part.patches) {
    solved += sum_of_channels(patch.solved);
    for (std::size_t b = 0; b < walked.size(); ++b) walked[b] += sum_of_channels(patch.walked[b]);
  }
  const auto [power, noise] = mean_of(walked);
  if (!(power > 0) || noise > most_noise * power) return {};
  const double square = relative_square(part, walked.size());
  // Jackknife over the batches.
  const double count = static_cast<double>(walked.size());
  std::array<double, walk_batches> left_out{};
  for (std::size_t b = 0; b < left_out.size(); ++b) left_out[b] = relative_square(part, b);
  const double spread = (count - 1) * mean_of(left_out).second;
  const double error = std::sqrt(std::max(square, 0.0));
  return {.power = solved / power - 1,
          .power_noise = noise / power * (solved / power),
          .error = error,
          .error_noise = std::sqrt(std::max(square, 0.0) + spread) - error};
}

}  // namespace quadgraph
