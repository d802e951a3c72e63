#include "engine/solve/workspace.h"

#include <algorithm>

#include "shaders/solver/solve_shared.h"

namespace quadgraph {
namespace {

std::uint64_t reduction_bytes(std::uint64_t elements) {
  return 4 + 3 * sizeof(glm::vec3) * device::workgroups(elements);
}

}  // namespace

Workspace::Workspace(device::Device& device, std::uint64_t max_elements)
    : recorder(device),
      reduction(device, reduction_bytes(max_elements), device::Place::device, "solver/reduction"),
      scale(device, sizeof(gpu::Scale), device::Place::device, "solver/scale") {
  start_over();
}

void Workspace::start_over() {
  recorder.abandon();
  recorder.fill(reduction, 0);
  recorder.submit();
}

}  // namespace quadgraph
