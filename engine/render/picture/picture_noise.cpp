#include "engine/render/picture/picture_noise.h"

#include <cmath>
#include <utility>

namespace quadgraph {
namespace {

constexpr float wholly = 0.999f;  // alpha from which on a pixel counts as covered

}  // namespace

void PictureNoise::Sums::add(std::vector<double> next, std::uint32_t count) {
  squares.resize(next.size());
  for (std::size_t i = 0; i < next.size() && count > 1; ++i) {
    const double step = next[i] - mean[i];
    squares[i] += static_cast<double>(count) * (count - 1) * step * step;
  }
  mean = std::move(next);
}

void PictureNoise::add(const Picture& mean) {
  ++count_;
  std::vector<double> radiance(mean.scattered.size()), scattered(mean.alpha.size());
  for (std::size_t i = 0; i < radiance.size(); ++i) {
    radiance[i] = double{mean.scattered[i]} + mean.specular[i] + mean.unscattered[i];
    scattered[i / 3] += mean.scattered[i];
  }
  covered_.assign(mean.alpha.size(), false);
  for (std::size_t i = 0; i < covered_.size(); ++i) covered_[i] = mean.alpha[i] > wholly;
  radiance_.add(std::move(radiance), count_);
  scattered_.add(std::move(scattered), count_);
}

double PictureNoise::variance(const Sums& sums, std::size_t i) const {
  return sums.squares[i] / (static_cast<double>(count_) * (count_ - 1));
}

std::vector<float> PictureNoise::standard_error() const {
  std::vector<float> error;
  for (std::size_t i = 0; i < radiance_.mean.size() && count_ > 1; ++i) {
    error.push_back(static_cast<float>(std::sqrt(variance(radiance_, i))));
  }
  return error;
}

double PictureNoise::relative() const {
  if (count_ < 2) return 0;
  double noise = 0, light = 0;
  for (std::size_t i = 0; i < covered_.size(); ++i) {
    if (!covered_[i]) continue;
    noise += variance(scattered_, i);
    light += scattered_.mean[i] * scattered_.mean[i];
  }
  return light > 0 ? std::sqrt(noise / light) : 0;
}

}  // namespace quadgraph
