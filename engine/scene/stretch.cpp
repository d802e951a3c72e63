#include "engine/scene/stretch.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>

namespace quadgraph {

// The roots of the characteristic polynomial of the symmetric product, by the cosine of a third of an angle.
std::array<double, 3> singular_values(const glm::dmat3& matrix) {
  const glm::dmat3 a = glm::transpose(matrix) * matrix;
  const double mean = (a[0][0] + a[1][1] + a[2][2]) / 3;
  const glm::dmat3 b = a - mean * glm::dmat3(1);
  const double spread = std::sqrt((glm::dot(b[0], b[0]) + glm::dot(b[1], b[1]) + glm::dot(b[2], b[2])) / 6);
  std::array<double, 3> values{mean, mean, mean};
  if (spread > 1e-15 * mean) {
    const double angle = std::acos(std::clamp(glm::determinant(b / spread) / 2, -1.0, 1.0)) / 3;
    values[0] = mean + 2 * spread * std::cos(angle);
    values[2] = mean + 2 * spread * std::cos(angle + 2 * std::numbers::pi / 3);
    values[1] = 3 * mean - values[0] - values[2];
  }
  for (double& value : values) value = std::sqrt(std::max(value, 0.0));
  return values;
}

void StretchCount::add(const glm::dmat3& back, double weight) {
  constexpr double least = 1e-6;  // mm of the source per mm of the body, that still count
  const std::array<double, 3> values = singular_values(back);
  for (int k = 0; k < axes_; ++k) {
    found_.push_back({1 / std::max(values[static_cast<std::size_t>(k)], least), weight});
  }
}

Stretch StretchCount::percentiles() const {
  std::vector<std::array<double, 2>> sorted = found_;
  std::sort(sorted.begin(), sorted.end());
  double whole = 0;
  for (const auto& [value, weight] : sorted) whole += weight;
  const auto at = [&](double share, double otherwise) {
    double sum = 0;
    for (const auto& [value, weight] : sorted) {
      sum += weight;
      if (sum >= share * whole) return value;
    }
    return otherwise;
  };
  return {.low = at(0.05, 1), .median = at(0.5, 1), .high = at(0.95, 1)};
}

}  // namespace quadgraph
