#include "engine/render/picture/pixel_filter.h"

#include <cmath>
#include <numbers>

namespace quadgraph {
namespace {

constexpr double gaussian_deviation = 0.5, gaussian_reach = 1.5, harris_width = 3.0;
constexpr std::array harris = {0.35875, 0.48829, 0.14128, 0.01168};  // Harris 1978, four terms, -92 dB

double reach(PixelFilter filter) {
  switch (filter) {
    case PixelFilter::box:
      return 0.5;
    case PixelFilter::tent:
      return 1;
    case PixelFilter::gaussian:
      return gaussian_reach;
    case PixelFilter::blackman_harris:
      return 0.5 * harris_width;
  }
  return 0;
}

double normal_below(double x) {
  return 0.5 * std::erfc(-x / (gaussian_deviation * std::numbers::sqrt2));
}

double harris_below(double x) {
  const double t = x / harris_width + 0.5;
  double sum = harris[0] * t, sign = -1;
  for (std::size_t k = 1; k < harris.size(); ++k, sign = -sign) {
    const double turn = 2 * std::numbers::pi * static_cast<double>(k);
    sum += sign * harris[k] * std::sin(turn * t) / turn;
  }
  return sum / harris[0];
}

// Share of the weight below x, which is within reach.
double below(PixelFilter filter, double x) {
  switch (filter) {
    case PixelFilter::box:
      return x + 0.5;
    case PixelFilter::tent:
      return 0.5 + x - 0.5 * x * std::abs(x);
    case PixelFilter::gaussian: {
      const double cut = normal_below(-gaussian_reach);
      return (normal_below(x) - cut) / (1 - 2 * cut);
    }
    case PixelFilter::blackman_harris:
      return harris_below(x);
  }
  return 0;
}

}  // namespace

double quantile(PixelFilter filter, double u) {
  if (filter == PixelFilter::box) return u - 0.5;
  double low = -reach(filter), high = reach(filter);
  for (int halving = 0; halving < 50; ++halving) {
    const double middle = 0.5 * (low + high);
    (below(filter, middle) < u ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double variance(PixelFilter filter) {
  if (filter == PixelFilter::box) return 1.0 / 12;
  if (filter == PixelFilter::tent) return 1.0 / 6;
  // By parts: what lies above x counts 2 x.
  constexpr int steps = 1000;
  const double step = reach(filter) / steps;
  double sum = 0;
  for (int k = 0; k < steps; ++k) {
    const double x = (k + 0.5) * step;
    sum += 4 * x * (1 - below(filter, x)) * step;
  }
  return sum;
}

}  // namespace quadgraph
