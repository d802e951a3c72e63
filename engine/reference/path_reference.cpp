#include "engine/reference/path_reference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <glm/geometric.hpp>
#include <queue>

#include "shaders/path/path_update.h"

namespace quadgraph {
namespace {

// Lengths of the cells around one, by their places in a cube of 27.
using CellNeighbours = std::array<double, 27>;

class Grid {
 public:
  Grid(const PathCells& cells, const std::vector<double>& length) : cells_(cells), length_(length) {}

  // Number of the cell `k` of the cube around one; none outside.
  std::int64_t neighbour(std::size_t cell, int k) const {
    const glm::ivec3 size(cells_.size);
    const auto number = static_cast<int>(cell);
    const glm::ivec3 at(number % size.x + k % 3 - 1, number / size.x % size.y + k / 3 % 3 - 1,
                        number / (size.x * size.y) + k / 9 - 1);
    for (int axis = 0; axis < 3; ++axis) {
      if (at[axis] < 0 || at[axis] >= size[axis]) return -1;
    }
    return at.x + std::int64_t{size.x} * (at.y + std::int64_t{size.y} * at.z);
  }

  bool solid(std::size_t cell) const { return cells_.cost[cell] >= 0; }

  // Cost of a path along a cell's side.
  double cost(std::size_t cell) const { return cells_.cell * static_cast<double>(cells_.cost[cell]); }

  CellNeighbours around(std::size_t cell) const {
    CellNeighbours found;
    found.fill(static_cast<double>(gpu::PATH_FAR));
    for (int k = 0; k < 27; ++k) {
      const std::int64_t other = neighbour(cell, k);
      if (other >= 0) found[k] = length_[static_cast<std::size_t>(other)];
    }
    return found;
  }

 private:
  const PathCells& cells_;
  const std::vector<double>& length_;
};

constexpr std::array<int, 3> strides = {1, 3, 9};

// Distance between the middles of a cell and of place k in the cube around it, cells.
double distance_to(int k) {
  const glm::dvec3 way(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
  return glm::length(way);
}

// The least through the triangles of neighbours at distances 1, sqrt(2) and sqrt(3), and their edges.
double through_triangles(const CellNeighbours& n, double cost) {
  double best = static_cast<double>(gpu::PATH_FAR);
  for (int k = 0; k < 48; ++k) {
    const int first = k % 3, second = (first + 1 + k / 3 % 2) % 3, third = 3 - first - second;
    const auto towards = [&](int axis, int bit) { return ((k / 6) >> bit & 1) != 0 ? strides[axis] : -strides[axis]; };
    const int i0 = 13 + towards(first, 0), i1 = i0 + towards(second, 1), i2 = i1 + towards(third, 2);
    const double t0 = n[i0], t1 = n[i1], t2 = n[i2], a = (t0 - t1) / cost, b = (t1 - t2) / cost;
    for (const double found :
         {t0 + cost * std::sqrt(gpu::triangle_rest(a, b)), t0 + cost * std::sqrt(gpu::edge_rest(a, 1, 1)),
          t1 + cost * std::sqrt(2 * gpu::edge_rest(b, 2, 1)),
          t0 + cost * std::sqrt(gpu::edge_rest((t0 - t2) / cost, 1, 2))}) {
      best = std::min(best, found);
    }
  }
  return best;
}

double through_neighbours(const CellNeighbours& n, double cost) {
  double best = static_cast<double>(gpu::PATH_FAR);
  for (int k = 0; k < 27; ++k) {
    if (k != 13) best = std::min(best, n[k] + cost * distance_to(k));
  }
  return best;
}

// Dijkstra's algorithm.
void settle(const Grid& grid, std::vector<double>& length) {
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  for (std::size_t i = 0; i < length.size(); ++i) {
    if (length[i] < static_cast<double>(gpu::PATH_FAR)) open.emplace(length[i], i);
  }
  while (!open.empty()) {
    const auto [so_far, cell] = open.top();
    open.pop();
    if (so_far > length[cell]) continue;
    for (int k = 0; k < 27; ++k) {
      const std::int64_t next = grid.neighbour(cell, k);
      if (k == 13 || next < 0) continue;
      const auto other = static_cast<std::size_t>(next);
      if (!grid.solid(other)) continue;
      const double step = 0.5 * (grid.cost(cell) + grid.cost(other)) * distance_to(k);
      if (so_far + step >= length[other]) continue;
      length[other] = so_far + step;
      open.emplace(length[other], other);
    }
  }
}

// Corrects labels until none falls.
void relax(const Grid& grid, std::vector<double>& length) {
  std::deque<std::size_t> open;
  std::vector<bool> waiting(length.size(), false);
  const auto wake = [&](std::size_t cell) {
    for (int k = 0; k < 27; ++k) {
      const std::int64_t next = grid.neighbour(cell, k);
      if (k == 13 || next < 0 || !grid.solid(static_cast<std::size_t>(next)) || waiting[static_cast<std::size_t>(next)])
        continue;
      waiting[static_cast<std::size_t>(next)] = true;
      open.push_back(static_cast<std::size_t>(next));
    }
  };
  for (std::size_t i = 0; i < length.size(); ++i) {
    if (length[i] < static_cast<double>(gpu::PATH_FAR)) wake(i);
  }
  while (!open.empty()) {
    const std::size_t cell = open.front();
    open.pop_front();
    waiting[cell] = false;
    const CellNeighbours n = grid.around(cell);
    const double cost = std::max(grid.cost(cell), 1e-30);
    const double found = std::min(through_neighbours(n, cost), through_triangles(n, cost));
    if (found >= length[cell]) continue;
    length[cell] = found;
    wake(cell);
  }
}

}  // namespace

std::vector<double> shortest_paths(const PathCells& cells, PathSolver solver) {
  std::vector<double> length(cells.start.begin(), cells.start.end());
  const Grid grid(cells, length);
  for (std::size_t i = 0; i < length.size(); ++i) {
    if (!grid.solid(i)) length[i] = static_cast<double>(gpu::PATH_FAR);
  }
  if (solver == PathSolver::lattice) {
    settle(grid, length);
  } else {
    relax(grid, length);
  }
  return length;
}

}  // namespace quadgraph
