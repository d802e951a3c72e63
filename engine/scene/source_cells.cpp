#include "engine/scene/source_cells.h"

#include <algorithm>
#include <glm/common.hpp>

namespace quadgraph {

glm::dvec3 CellGrid::place(std::size_t cell) const {
  const std::size_t x = cell % cells[0], y = cell / cells[0] % cells[1], z = cell / (cells[0] * cells[1]);
  return first + spacing * glm::dvec3(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
}

SourceCells::SourceCells(const Volume& volume, const glm::dvec3& centre)
    : like_(volume),
      grid_{.cells = volume.cells, .first = volume.first(centre), .spacing = volume.spacing},
      last_(static_cast<double>(volume.cells[0] - 1), static_cast<double>(volume.cells[1] - 1),
            static_cast<double>(volume.cells[2] - 1)) {
  for (std::size_t i = 0; i < knowledge_names.size(); ++i) {
    if (!volume.certainty.stated[i].empty()) stated_.push_back(static_cast<Knowledge>(i));
  }
  channels_ += stated_.size();
  values_.reserve(channels_ * grid_.count());
  for (std::size_t cell = 0; cell < grid_.count(); ++cell) {
    const gpu::Optical& optical = volume.optical[cell];
    for (int c = 0; c < 3; ++c) values_.push_back(optical.sigma_s_prime[c]);
    for (int c = 0; c < 3; ++c) values_.push_back(optical.sigma_a[c]);
    for (Knowledge knowledge : stated_) values_.push_back(volume.certainty.of(knowledge)[cell]);
  }
}

void SourceCells::add(const glm::dvec3& place, double weight, std::span<float> sums) const {
  const glm::dvec3 at = glm::clamp((place - grid_.first) / grid_.spacing, glm::dvec3(0), last_);
  std::array<std::array<std::size_t, 2>, 3> cell{};
  std::array<std::array<double, 2>, 3> share{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<std::size_t>(axis);
    cell[k][0] = static_cast<std::size_t>(at[axis]);
    cell[k][1] = std::min(cell[k][0] + 1, grid_.cells[k] - 1);
    share[k][1] = at[axis] - static_cast<double>(cell[k][0]);
    share[k][0] = 1 - share[k][1];
  }
  for (std::size_t corner = 0; corner < 8; ++corner) {
    const std::size_t x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
    const double part = weight * share[0][x] * share[1][y] * share[2][z];
    if (part == 0) continue;
    const std::size_t index = cell[0][x] + grid_.cells[0] * (cell[1][y] + grid_.cells[1] * cell[2][z]);
    for (std::size_t k = 0; k < channels_; ++k) sums[k] += static_cast<float>(part) * values_[index * channels_ + k];
  }
}

Volume SourceCells::volume_of(const CellGrid& grid, std::span<const float> values, double longer) const {
  Volume made;
  made.cells = grid.cells;
  made.spacing = grid.spacing;
  made.origin = grid.first;
  made.eta = like_.eta;
  made.optical.reserve(grid.count());
  for (std::size_t cell = 0; cell < grid.count(); ++cell) {
    const float* v = &values[cell * channels_];
    made.optical.push_back({glm::vec3(v[0], v[1], v[2]), glm::vec3(v[3], v[4], v[5])});
    for (std::size_t k = 0; k < stated_.size(); ++k) {
      const auto factor = static_cast<float>(is_length(stated_[k]) ? longer : 1.0);
      made.certainty.stated[static_cast<std::size_t>(stated_[k])].push_back(
          std::min(factor * v[6 + k], most_stated(stated_[k])));
    }
  }
  return made;
}

}  // namespace quadgraph
