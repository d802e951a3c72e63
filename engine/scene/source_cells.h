// All that a volume says of its cells, to be read at places and written into another volume.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/scene/volume.h"

namespace quadgraph {

// Where the cells of a volume lie.
struct CellGrid {
  std::array<std::size_t, 3> cells{1, 1, 1};
  glm::dvec3 first{0}, spacing{1};  // mm

  std::size_t count() const { return cells[0] * cells[1] * cells[2]; }
  glm::dvec3 place(std::size_t cell) const;
};

class SourceCells {
 public:
  // `centre`: of the body that the volume lies in, mm.
  SourceCells(const Volume& volume, const glm::dvec3& centre);

  // Of a cell: six coefficients, and what is stated of how well they are known.
  std::size_t channels() const { return channels_; }
  const CellGrid& grid() const { return grid_; }
  glm::dvec3 low() const { return grid_.first; }  // the middles of the outermost cells, mm
  glm::dvec3 high() const { return grid_.first + grid_.spacing * last_; }
  bool varies_along(int axis) const { return grid_.cells[static_cast<std::size_t>(axis)] > 1; }

  // Adds `weight` times what is at a place, mm, to `sums`: linear between the middles of cells, beside them the
  // nearest.
  void add(const glm::dvec3& place, double weight, std::span<float> sums) const;

  // The volume of other cells, whose channels these are; `longer`: factor of the lengths that are stated.
  Volume volume_of(const CellGrid& grid, std::span<const float> values, double longer) const;

 private:
  const Volume& like_;
  CellGrid grid_;
  glm::dvec3 last_;
  std::vector<Knowledge> stated_;
  std::size_t channels_ = 6;
  std::vector<float> values_;  // channels of a cell beside each other
};

}  // namespace quadgraph
