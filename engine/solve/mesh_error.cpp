#include "engine/solve/mesh_error.h"

#include <algorithm>
#include <cmath>

namespace quadgraph {
namespace {

constexpr double least_ratio = 0.25, largest_ratio = 0.8, first_order = 0.5;

double tail(double ratio) {
  return ratio / std::sqrt(1 - ratio * ratio);
}

double error_of(double difference, std::optional<double> coarser) {
  double ratio = first_order;
  if (coarser && *coarser > 0) ratio = std::clamp(difference / *coarser, least_ratio, largest_ratio);
  return difference * std::sqrt(tail(ratio) * tail(first_order));
}

}  // namespace

ErrorEstimate mesh_error(const ErrorEstimate& difference, const std::optional<ErrorEstimate>& coarser) {
  if (coarser) return by_parts(error_of, difference, *coarser);
  return by_parts([](double part) { return error_of(part, std::nullopt); }, difference);
}

}  // namespace quadgraph
