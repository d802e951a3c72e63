#include "engine/reference/tet_locator.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>

namespace quadgraph {
namespace {

constexpr double slack = 1e-3;   // of a tet's height
constexpr int most_cells = 256;  // along an axis

glm::dvec4 barycentric_in(const Level& level, std::uint32_t tet, const glm::dvec3& point) {
  const glm::uvec4& v = level.tets[tet];
  const glm::dvec3 a(level.vertices[v.x]);
  const glm::dvec3 b = glm::dvec3(level.vertices[v.y]) - a, c = glm::dvec3(level.vertices[v.z]) - a,
                   d = glm::dvec3(level.vertices[v.w]) - a, p = point - a;
  const double volume = glm::dot(b, glm::cross(c, d));
  const double y = glm::dot(p, glm::cross(c, d)) / volume, z = glm::dot(b, glm::cross(p, d)) / volume,
               w = glm::dot(b, glm::cross(c, p)) / volume;
  return {1 - y - z - w, y, z, w};
}

double least(const glm::dvec4& v) {
  return std::min(std::min(v.x, v.y), std::min(v.z, v.w));
}

}  // namespace

TetLocator::TetLocator(const Level& level) : level_(level), low_(level.vertices[0]), high_(low_) {
  for (const glm::vec3& v : level.vertices) {
    low_ = glm::min(low_, glm::dvec3(v));
    high_ = glm::max(high_, glm::dvec3(v));
  }
  const glm::dvec3 box = high_ - low_;
  const double longest = std::max(box.x, std::max(box.y, box.z));
  side_ = std::max(std::cbrt(box.x * box.y * box.z / level.tet_count()), longest / most_cells);
  size_ = glm::max(glm::ivec3(glm::ceil(box / side_)), glm::ivec3(1));
  begin_.assign(
      static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y) * static_cast<std::size_t>(size_.z) + 1, 0);
  for (std::uint32_t t = 0; t < level.tet_count(); ++t) each_cell(t, [&](std::size_t cell) { ++begin_[cell + 1]; });
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  tets_.resize(begin_.back());
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  for (std::uint32_t t = 0; t < level.tet_count(); ++t)
    each_cell(t, [&](std::size_t cell) { tets_[next[cell]++] = t; });
}

glm::ivec3 TetLocator::cell_of(const glm::dvec3& point) const {
  return glm::clamp(glm::ivec3(glm::floor((glm::clamp(point, low_, high_) - low_) / side_)), glm::ivec3(0), size_ - 1);
}

std::size_t TetLocator::index_of(const glm::ivec3& cell) const {
  return static_cast<std::size_t>(cell.x + size_.x * (cell.y + size_.y * cell.z));
}

template <typename Visit>
void TetLocator::each_cell(std::uint32_t tet, const Visit& visit) const {
  const glm::uvec4& v = level_.tets[tet];
  glm::dvec3 low(level_.vertices[v.x]), high = low;
  for (int corner = 1; corner < 4; ++corner) {
    low = glm::min(low, glm::dvec3(level_.vertices[v[corner]]));
    high = glm::max(high, glm::dvec3(level_.vertices[v[corner]]));
  }
  const glm::dvec3 margin = slack * (high - low);
  const glm::ivec3 first = cell_of(low - margin), last = cell_of(high + margin);
  for (int z = first.z; z <= last.z; ++z) {
    for (int y = first.y; y <= last.y; ++y) {
      for (int x = first.x; x <= last.x; ++x) visit(index_of({x, y, z}));
    }
  }
}

std::optional<TetLocator::Place> TetLocator::find(const glm::dvec3& point) const {
  const std::size_t cell = index_of(cell_of(point));
  std::optional<Place> found;
  double best = -slack;
  for (std::uint32_t i = begin_[cell]; i < begin_[cell + 1]; ++i) {
    const glm::dvec4 place = barycentric_in(level_, tets_[i], point);
    if (!(least(place) >= best)) continue;
    best = least(place);
    found = Place{tets_[i], place};
  }
  if (found) {
    const glm::dvec4 inside = glm::max(found->barycentric, glm::dvec4(0));
    found->barycentric = inside / (inside.x + inside.y + inside.z + inside.w);
  }
  return found;
}

}  // namespace quadgraph
