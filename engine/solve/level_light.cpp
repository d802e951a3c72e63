#include "engine/solve/level_light.h"

#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/device/memory.h"

namespace quadgraph {
namespace {

// shaders/source/beam_light.glsl on the host.
glm::vec3 beam_light(const gpu::Beam& beam, std::span<const float> stored, std::uint32_t quarter) {
  if (beam.floats == gpu::BEAM_RGB) return {stored[0], stored[1], stored[2]};
  if (beam.floats == gpu::BEAM_RGB_QUARTERS) {
    const auto at = stored.subspan(3 * quarter, 3);
    return glm::vec3(at[0], at[1], at[2]) * beam.colour;
  }
  return stored[beam.floats == gpu::BEAM_QUARTERS ? quarter : 0] * beam.colour;
}

}  // namespace

std::vector<LevelBeam> level_light(device::Device& device, const BeamBuffers& beams, const LevelBuffers& level) {
  const std::vector<float> stored = device::download<float>(device, level.beam_q);
  std::vector<LevelBeam> light;
  for (const gpu::Beam& beam : std::span(beams.beams).first(beams.beams.size() - 1)) {
    LevelBeam& read = light.emplace_back();
    read.way = beam.way;
    for (std::size_t f = 0; f < level.face_count; ++f) {
      const auto of_face =
          std::span(stored).subspan(std::size_t{beam.offset} * level.face_count + beam.floats * f, beam.floats);
      Quarters& quarters = read.quarters.emplace_back();
      for (std::uint32_t k = 0; k < 4; ++k) quarters[k] = beam_light(beam, of_face, k);
    }
  }
  return light;
}

}  // namespace quadgraph
