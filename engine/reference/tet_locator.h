// Which tet of a level holds a point.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <vector>

#include "engine/file/graph.h"

namespace quadgraph {

class TetLocator {
 public:
  struct Place {
    std::uint32_t tet = 0;
    glm::dvec4 barycentric{0};  // of the tet's vertices in their order; none below 0, sum 1
  };

  // Sorts the tets of `level` into the cells of a regular grid. `level` must outlive the locator.
  explicit TetLocator(const Level& level);

  // The place of `point`, mm. A point outside the body by no more than a thousandth of a tet's height counts as on its
  // surface; nothing for one farther away.
  std::optional<Place> find(const glm::dvec3& point) const;

 private:
  glm::ivec3 cell_of(const glm::dvec3& point) const;
  std::size_t index_of(const glm::ivec3& cell) const;
  template <typename Visit>
  void each_cell(std::uint32_t tet, const Visit& visit) const;

  const Level& level_;
  glm::dvec3 low_{0}, high_{0};              // mm, box around the vertices
  double side_ = 1;                          // mm, of a cell
  glm::ivec3 size_{1};                       // cells along x, y, z
  std::vector<std::uint32_t> begin_, tets_;  // cell c is touched by tets_[begin_[c]] ... tets_[begin_[c + 1] - 1]
};

}  // namespace quadgraph
