// Shortest paths on the cells of a grid on the CPU, in double precision: what the GPU's are compared with.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/base/path_options.h"

namespace quadgraph {

// One channel, cell (x, y, z) at x + size.x (y + size.y z).
struct PathCells {
  glm::uvec3 size{0};
  double cell = 1;               // mm, side of a cell
  std::span<const float> cost;   // 1/mm, >= 0; below 0: not solid
  std::span<const float> start;  // lengths before the first step; gpu::PATH_FAR: none
};

// Lengths of the shortest paths from the starts, gpu::PATH_FAR where none leads. An edge between neighbours of the
// lattice costs the mean of both times the distance of their middles; other paths cost in the side of a cell's
// neighbourhood (shaders/path/path_update.h) what that cell does.
std::vector<double> shortest_paths(const PathCells& cells, PathSolver solver);

}  // namespace quadgraph
