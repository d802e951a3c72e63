// The levels of a file with their vertices moved: a body that deforms keeps its tets, links and transfers.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/file/graph.h"

namespace quadgraph {

class MovedLevels {
 public:
  // `graph` must stay alive.
  explicit MovedLevels(const QuadGraph& graph) : rest_(graph.levels()), levels_(rest_), vertices_(rest_.size()) {
    nodes_.resize(rest_.size());
  }

  // The levels as the file has them.
  const std::vector<Level>& rest() const { return rest_; }

  // The levels with their present vertices and nodes.
  const std::vector<Level>& levels() const { return levels_; }

  // Moves the vertices of level `number` to `positions`, mm; every node keeps its place in its tet. Throws InputError
  // without moving anything if there is no such level, on a wrong size, a position that is not finite, or a tet that
  // has no volume left or is turned inside out.
  void move(std::uint32_t number, std::span<const glm::vec3> positions);

  // Moves like `move`, without checking the tets.
  void place(std::uint32_t number, std::span<const glm::vec3> positions);

  // All levels as the file has them.
  void put_back() { levels_ = rest_; }

 private:
  const std::vector<Level>& rest_;
  std::vector<Level> levels_;
  std::vector<std::vector<glm::vec3>> vertices_, nodes_;  // of the levels that have moved
};

}  // namespace quadgraph
