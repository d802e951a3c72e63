#include "engine/render/light/light_samples.h"

#include "engine/device/commands.h"
#include "interface/light/light_error.comp.h"

namespace quadgraph {

const device::ComputePass& LightSamples::pass(bool shaped) {
  std::optional<device::ComputePass>& pass = shaped ? shaped_ : plain_;
  if (!pass) pass.emplace(device_, shader::light_error, device::ComputeOptions{.variant = shaped ? 1u : 0u});
  return *pass;
}

PassStats LightSamples::run(const LevelBuffers& level, const ShadowMaps& lights, const LightRoom& room) {
  gpu::LightErrorPush push{.vertices = level.vertices.address(),
                           .faces = level.faces.address(),
                           .face_kinds = level.face_kind.address(),
                           .beam_q = level.beam_q.address(),
                           .sky = level.sky.address(),
                           .beams = room.beams.address(),
                           .lights = lights.lights().address(),
                           .shapes = lights.shapes().address(),
                           .views = lights.views().address(),
                           .tree = room.tree,
                           .difference = room.difference.address(),
                           .light_count = lights.light_count(),
                           .rays = room.rays,
                           .turn = 0,
                           .sky_share = room.sky_share};
  device::Commands commands(device_, 1);
  commands.begin_pass("light error");
  const device::ComputePass& samples = pass(lights.shaped());
  for (; push.turn < gpu::LIGHT_TURNS; ++push.turn) {
    commands.dispatch(samples, push, std::uint64_t{gpu::LIGHT_SAMPLES} * level.face_count);
  }
  commands.dispatch(samples, push, level.face_count);
  commands.end_pass();
  const auto times = commands.submit_and_wait();
  // Per face and dispatch: indices and corners, and what is added to. Of rays through the tree nothing is counted.
  const std::uint64_t bytes = sizeof(glm::uvec3) + (3 + 2 * gpu::LIGHT_SAMPLES) * sizeof(glm::vec3);
  constexpr std::uint32_t dispatches = gpu::LIGHT_TURNS + 1;
  return {times[0].name, times[0].time_ms, dispatches * level.face_count * bytes, dispatches};
}

}  // namespace quadgraph
