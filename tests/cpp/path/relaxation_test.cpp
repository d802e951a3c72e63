// Shortest paths on the device against the CPU reference.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "engine/device/pipeline.h"
#include "engine/path/given_cells.h"
#include "engine/reference/path_reference.h"
#include "tests/cpp/fixtures/checked_context.h"

using namespace quadgraph;

TEST_CASE("paths through random cells are as long as the reference says") {
  CheckedContext checked;
  device::Device& context = checked.context;
  std::mt19937 random(7);
  std::uniform_real_distribution<float> share(0, 1);
  for (const glm::uvec3 size : {glm::uvec3(16, 8, 24), glm::uvec3(40, 16, 8)}) {
    const std::size_t count = std::size_t{size.x} * size.y * size.z;
    std::vector<float> cost(3 * count), start(3 * count, gpu::PATH_FAR);
    for (std::size_t i = 0; i < 3 * count; ++i) {
      cost[i] = share(random) < 0.3f ? -1.0f : std::exp(4 * share(random) - 2);
      if (cost[i] >= 0 && share(random) < 0.01f) start[i] = 3 * share(random);
    }
    for (std::size_t i = 0; i < count; ++i) {
      // All channels are solid in the same cells.
      for (int c = 1; c < 3; ++c) {
        if (cost[i] < 0) cost[c * count + i] = -1;
        if (cost[i] >= 0 && cost[c * count + i] < 0) cost[c * count + i] = 0.2f;
        if (cost[i] < 0) start[c * count + i] = gpu::PATH_FAR;
      }
    }
    for (const PathSolver solver : {PathSolver::lattice, PathSolver::eikonal}) {
      std::vector<float> entering(3 * count, 0), begun(3 * count, gpu::PATH_FAR);
      for (std::size_t i = 0; i < 3 * count; ++i) {
        if (start[i] >= gpu::PATH_FAR) continue;
        entering[i] = std::exp(-start[i]);
        begun[i] = -std::log(entering[i]);
      }
      const std::vector<float> found = paths_through(context, size, 0.7f, cost, entering, solver);
      for (std::size_t c = 0; c < 3; ++c) {
        const std::vector<double> wanted = shortest_paths({.size = size,
                                                           .cell = static_cast<double>(0.7f),
                                                           .cost = std::span(cost).subspan(c * count, count),
                                                           .start = std::span(begun).subspan(c * count, count)},
                                                          solver);
        double worst = 0;
        for (std::size_t i = 0; i < count; ++i) {
          worst = std::max(worst, std::abs(static_cast<double>(found[c * count + i]) - wanted[i]) / (1 + wanted[i]));
        }
        CHECK(worst < (solver == PathSolver::lattice ? 2e-6 : 5e-6));
      }
    }
  }
}
