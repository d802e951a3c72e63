#include "engine/scene/source_domain.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>

namespace quadgraph {
namespace {

constexpr double most_cells = 1e6;
constexpr double fills = 1e-3;  // share of a box that a block may lack

bool is_block(const BodySurface& surface) {
  const glm::dvec3 size = surface.high() - surface.low();
  const double box = size.x * size.y * size.z;
  return std::abs(surface.volume() - box) <= fills * box;
}

}  // namespace

SourceDomain::SourceDomain(const Volume& volume, const MaterialMap& map) {
  glm::dvec3 centre(0);
  if (!map.from.empty()) {
    body_ = QuadGraph::load(map.from);
    surface_ = std::make_unique<BodySurface>(*body_);
    low_ = surface_->low();
    high_ = surface_->high();
    centre = middle();
  }
  cells_ = std::make_unique<SourceCells>(volume, centre);
  if (!surface_) {
    low_ = cells_->low();
    high_ = cells_->high();
  } else if (is_block(*surface_)) {
    surface_.reset();
  }
}

glm::dvec3 SourceDomain::fit(const BodySurface& body) const {
  const glm::dvec3 wide = body.high() - body.low();
  glm::dvec3 factors(1);
  for (int axis = 0; axis < 3; ++axis) {
    if (wide[axis] > 0) factors[axis] = size()[axis] / wide[axis];
  }
  return factors;
}

int SourceDomain::axes() const {
  int count = 0;
  for (int axis = 0; axis < 3; ++axis) count += cells_->varies_along(axis) ? 1 : 0;
  return count;
}

double SourceDomain::least_side() const {
  double least = std::numeric_limits<double>::max();
  for (int axis = 0; axis < 3; ++axis) {
    if (cells_->varies_along(axis)) least = std::min(least, size()[axis]);
  }
  return least;
}

double SourceDomain::within(double place, int axis, MapRepeat repeat) const {
  const double low = low_[axis], high = high_[axis], side = high - low;
  if (place >= low && place <= high) return place;
  if (repeat == MapRepeat::clamp || !(side > 0)) return std::clamp(place, low, high);
  const double turn = std::fmod(place - low, 2 * side), along = turn < 0 ? turn + 2 * side : turn;
  return low + (along > side ? 2 * side - along : along);
}

CellGrid grid_around(const glm::dvec3& low, const glm::dvec3& high, const glm::dvec3& anchor, glm::dvec3 spacing,
                     double& coarser) {
  constexpr double rounding = 1e-6;  // of a cell, by which a box may lie beyond the last one
  coarser = 1;
  spacing = glm::max(spacing, (high - low) / most_cells);
  while (true) {
    CellGrid grid{.spacing = spacing};
    double count = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const double first = std::floor((low[axis] - anchor[axis]) / spacing[axis] + rounding),
                   last = std::ceil((high[axis] - anchor[axis]) / spacing[axis] - rounding);
      grid.first[axis] = anchor[axis] + first * spacing[axis];
      grid.cells[static_cast<std::size_t>(axis)] = static_cast<std::size_t>(std::min(last - first, most_cells)) + 1;
      count *= last - first + 1;
    }
    if (count <= most_cells) return grid;
    const double factor = 1.01 * std::cbrt(count / most_cells);
    spacing *= factor;
    coarser *= factor;
  }
}

}  // namespace quadgraph
