#include "engine/path/exit_field.h"

#include <glm/common.hpp>
#include <glm/vec4.hpp>

#include "engine/path/path_pass.h"
#include "interface/path/path_field.comp.h"

namespace quadgraph {

ExitField::ExitField(device::Device& device)
    : device_(device),
      pass_(device, shader::path_field),
      record_(device, sizeof(gpu::PathField), device::Place::device, "path/field") {}

void ExitField::run(const Voxels& voxels, const PathRelaxation& paths, const gpu::PathTools& tools,
                    std::vector<PassStats>& passes) {
  grid_ = voxels.grid();
  const std::uint64_t count = gpu::cell_count(grid_);
  make_room(device_, cells_, count * sizeof(glm::vec4), device::Place::device, "path/field of cells");
  const gpu::PathField record{grid_, cells_.address(), tools};
  const gpu::PathFieldPush push{grid_, voxels.cells().flags.address(), paths.lengths().address(), cells_.address()};
  run_pass(device_, "path field", 32 * count, passes, [&](device::Commands& commands) {
    commands.update(record_, std::as_bytes(std::span(&record, 1)));
    commands.dispatch(pass_, push, count);
  });
}

std::vector<glm::vec3> ExitField::at(std::span<const glm::vec3> points) const {
  std::vector<glm::vec4> cells(gpu::cell_count(grid_));
  device::read_bytes(device_, cells_, std::as_writable_bytes(std::span(cells)));
  std::vector<glm::vec3> found;
  found.reserve(points.size());
  for (const glm::vec3& point : points) {
    const glm::vec3 place =
        glm::clamp((point - grid_.origin) / grid_.cell - 0.5f, glm::vec3(0), glm::vec3(grid_.size) - 1.001f);
    const glm::uvec3 low(place);
    const glm::vec3 f = place - glm::vec3(low);
    glm::vec4 sum(0);
    for (std::uint32_t k = 0; k < 8; ++k) {
      const glm::uvec3 corner(k & 1u, k >> 1u & 1u, k >> 2u);
      const glm::vec3 share = glm::mix(1.0f - f, f, glm::vec3(corner));
      sum += share.x * share.y * share.z * cells[gpu::cell_number(grid_, low + corner)];
    }
    found.push_back(sum.w > 0 ? glm::vec3(sum) / sum.w : glm::vec3(0));
  }
  return found;
}

}  // namespace quadgraph
