#include "engine/solve/workspace.h"

#include "shaders/solve_shared.h"

namespace quadgraph {

Workspace::Workspace(vk::Context& context, std::uint64_t max_elements)
    : recorder(context),
      reduction(context, 4 + 2 * sizeof(glm::vec3) * (max_elements / WORKGROUP_SIZE + 1), vk::Place::device,
                "solver/reduction"),
      scale(context, sizeof(gpu::Scale), vk::Place::read, "solver/scale") {
  recorder.fill(reduction, 0);
  recorder.submit();
}

}  // namespace quadgraph
