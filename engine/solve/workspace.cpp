#include "engine/solve/workspace.h"

#include <algorithm>

#include "shaders/solver/solve_shared.h"

namespace quadgraph {
namespace {

std::uint64_t reduction_bytes(vk::Context& context, std::uint64_t elements) {
  const std::uint64_t groups =
      std::max<std::uint64_t>(elements / WORKGROUP_SIZE + 1, vk::strided_workgroups(context, elements));
  return 4 + 2 * sizeof(glm::vec3) * groups;
}

}  // namespace

Workspace::Workspace(vk::Context& context, std::uint64_t max_elements)
    : recorder(context),
      reduction(context, reduction_bytes(context, max_elements), vk::Place::device, "solver/reduction"),
      scale(context, sizeof(gpu::Scale), vk::Place::read, "solver/scale") {
  recorder.fill(reduction, 0);
  recorder.submit();
}

}  // namespace quadgraph
