#include "engine/render/light/irradiance.h"

#include "interface/light/irradiance.comp.h"

namespace quadgraph {
namespace {

// 16 samples on a face of the finest level, and two more rows per level: faces get twice as long, but a coarse level
// only starts the finer one and estimates its error.
constexpr std::uint32_t finest_subdivision = 4;
constexpr std::uint32_t more_per_level = 2;
static_assert(finest_subdivision % 2 == 0 && more_per_level % 2 == 0, "a sample lies in one quarter of its face");

// In motion 16 samples on every level, and a sample a quarter where faces are as small as on bodies that take long.
constexpr std::uint32_t many_faces = 32768;

std::uint32_t subdivision_of(std::uint32_t level, std::uint32_t faces, bool rough) {
  if (rough) return faces < many_faces ? finest_subdivision : 2;
  return finest_subdivision + more_per_level * level;
}

}  // namespace

IrradiancePass::IrradiancePass(device::Device& device) : device_(device), pass_(device, shader::irradiance) {}

const device::ComputePass& IrradiancePass::pass(bool shaped) {
  if (!shaped) return pass_;
  if (!shaped_) shaped_.emplace(device_, shader::irradiance, device::ComputeOptions{.variant = 1});
  return *shaped_;
}

std::uint64_t IrradiancePass::record(device::Commands& commands, const LevelBuffers& buffers, std::uint32_t level,
                                     const ShadowMaps& shadows, std::uint64_t hidden, bool rough) {
  const std::uint32_t subdivision = subdivision_of(level, buffers.face_count, rough);
  const gpu::IrradiancePush push{.vertices = buffers.vertices.address(),
                                 .faces = buffers.faces.address(),
                                 .face_kinds = buffers.face_kind.address(),
                                 .q = buffers.q.address(),
                                 .beam_q = buffers.beam_q.address(),
                                 .sky = buffers.sky.address(),
                                 .hidden = hidden,
                                 .lights = shadows.lights().address(),
                                 .shapes = shadows.shapes().address(),
                                 .views = shadows.views().address(),
                                 .face_count = buffers.face_count,
                                 .light_count = shadows.light_count(),
                                 .subdivision = subdivision};
  commands.begin_pass("irradiance");
  commands.dispatch(pass(shadows.shaped()), push, buffers.face_count);
  commands.end_pass();
  // Per face: three indices, three corners, q; per light its quarters, and four texels per sample.
  const std::uint64_t light_bytes = sizeof(float) * FACE_QUARTERS + 16ull * subdivision * subdivision;
  return buffers.face_count * (12 + 36 + 12 + 4 + shadows.light_count() * light_bytes);
}

}  // namespace quadgraph
