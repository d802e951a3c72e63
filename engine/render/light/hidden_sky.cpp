#include "engine/render/light/hidden_sky.h"

#include "engine/device/commands.h"
#include "interface/light/environment_finer.comp.h"
#include "interface/light/environment_hidden.comp.h"

namespace quadgraph {

HiddenSky::HiddenSky(device::Device& device, const QuadGraph& graph)
    : device_(device),
      graph_(graph),
      hide_(device, shader::environment_hidden, {.variant = 1}),
      refine_(device, shader::environment_finer) {}

void HiddenSky::make_room(Simulation& simulation, std::uint32_t level, std::uint32_t environments) {
  hidden_.resize(level + 1);
  for (std::uint32_t i = 0; i <= level; ++i) {
    const std::uint64_t bytes = std::uint64_t{environments} * simulation.level(i).face_count * sizeof(glm::vec3);
    if (hidden_[i].size() != bytes) hidden_[i] = {device_, bytes, device::Place::device, "light/hidden environment"};
  }
  for (auto i = static_cast<std::uint32_t>(finer_.size()); i < level; ++i) {
    const Transfer& surface = graph_.levels()[i].surface;
    finer_.push_back({device::upload(device_, surface.index, "light/surface_index"),
                      device::upload(device_, surface.weight, "light/surface_weight"), surface.width});
  }
}

PassStats HiddenSky::run(Simulation& simulation, const ShadowMaps& lights, std::uint32_t environments) {
  PassStats stats{.name = "hidden environment"};
  const std::optional<SeenRows> seen = simulation.seen();
  if (!seen) {
    hidden_.clear();
    return stats;
  }
  make_room(simulation, seen->level, environments);
  const LevelBuffers& level = simulation.level(seen->level);
  device::Commands commands(device_, 1);
  commands.begin_pass(stats.name);
  commands.dispatch(hide_,
                    gpu::EnvironmentHiddenPush{.vertices = level.vertices.address(),
                                               .faces = level.faces.address(),
                                               .face_kinds = level.face_kind.address(),
                                               .rows = seen->rows.address(),
                                               .entries = seen->entries.address(),
                                               .lights = lights.lights().address(),
                                               .shapes = lights.shapes().address(),
                                               .hidden = hidden_[seen->level].address(),
                                               .face_count = level.face_count,
                                               .light_count = lights.light_count(),
                                               .rays = static_cast<float>(seen->rays)},
                    level.face_count);
  stats.bytes = seen->entries.size() + seen->rows.size() + hidden_[seen->level].size();
  for (std::uint32_t i = seen->level; i-- > 0;) {
    commands.dispatch(refine_,
                      gpu::EnvironmentFinerPush{.index = finer_[i].index.address(),
                                                .weight = finer_[i].weight.address(),
                                                .coarse = hidden_[i + 1].address(),
                                                .hidden = hidden_[i].address(),
                                                .width = finer_[i].width,
                                                .face_count = simulation.level(i).face_count,
                                                .coarse_count = simulation.level(i + 1).face_count,
                                                .environments = environments},
                      simulation.level(i).face_count);
    stats.bytes += finer_[i].index.size() + finer_[i].weight.size() + 2 * hidden_[i].size();
  }
  commands.end_pass();
  stats.time_ms = commands.submit_and_wait()[0].time_ms;
  stats.count = seen->level + 1;
  return stats;
}

}  // namespace quadgraph
