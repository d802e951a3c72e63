#include "engine/solve/beams.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <string>

#include "engine/base/error.h"
#include "engine/base/range.h"
#include "engine/base/text.h"
#include "engine/device/commands.h"

namespace quadgraph {
namespace {

// W/mm^2. Solves are scaled; summed over a surface it is within single precision.
constexpr Range irradiance_range{.low = 0, .high = 1e30};

void check_irradiance(std::span<const glm::vec3> q, std::uint32_t level, std::uint32_t count) {
  if (q.size() != count) {
    throw InputError("irradiance of level " + std::to_string(level) + ": " + std::to_string(q.size()) +
                     " values, one for each of the " + std::to_string(count) + " surface nodes is wanted");
  }
  for (std::size_t i = 0; i < q.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      if (irradiance_range.contains(q[i][c])) continue;
      throw InputError("irradiance of level " + std::to_string(level) + ", surface node " + std::to_string(i) +
                       ", channel " + std::to_string(c) + ": found " + number_text(q[i][c]) + ", allowed is " +
                       irradiance_range.text());
    }
  }
}

gpu::Beam rgb_beam(const gpu::BeamRecord& way) {
  return {way, glm::vec3(0), gpu::BEAM_RGB, 0, 0};
}

// Both store the same per face, one after the other.
bool alike(std::span<const gpu::Beam> a, std::span<const gpu::Beam> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const gpu::Beam& x, const gpu::Beam& y) { return x.floats == y.floats; });
}

// Room for so many numbers per face on every level, without light.
void make_room(device::Device& device, std::uint32_t floats, std::vector<LevelBuffers>& levels) {
  device::Commands commands(device);
  for (LevelBuffers& level : levels) {
    const std::uint64_t bytes = std::uint64_t{floats} * level.face_count * sizeof(float);
    if (level.beam_q.size() != bytes) level.beam_q = {device, bytes, device::Place::device, "light/beams on faces"};
    commands.fill(level.beam_q, 0);
    commands.fill(level.q, 0);
  }
  commands.submit_and_wait();
}

}  // namespace

gpu::Beam beam_along(const std::optional<glm::vec3>& direction) {
  if (!direction) return rgb_beam({gpu::BEAM_LAMBERTIAN, {}, {}, {}});
  const double length = glm::length(glm::dvec3(*direction));
  if (!std::isfinite(length) || length == 0) {
    throw InputError("direction of the light: " + std::to_string(direction->x) + ", " + std::to_string(direction->y) +
                     ", " + std::to_string(direction->z) + ", finite numbers that are not all zero are wanted");
  }
  return rgb_beam({gpu::BEAM_DIRECTIONAL, glm::vec3(glm::dvec3(*direction) / length), {}, {}});
}

void replace_beams(device::Device& device, std::span<const gpu::Beam> beams, BeamBuffers& buffers,
                   std::vector<LevelBuffers>& levels) {
  std::vector<gpu::Beam> all(beams.begin(), beams.end());
  all.push_back(rgb_beam({gpu::BEAM_MEAN, {}, {}, {}}));
  std::uint32_t floats = 0;
  for (gpu::Beam& beam : all) {
    beam.offset = floats;
    floats += beam.floats;
  }
  const bool fits = alike(all, buffers.beams);
  buffers.beams.clear();  // none are known until all is done, as it may be given up half-way
  const std::span<const gpu::Beam> records(all);
  if (fits) {
    device::write_bytes(device, buffers.on_device, std::as_bytes(records));
  } else {
    buffers.on_device = device::upload(device, records, "light/beams");
    make_room(device, floats, levels);
  }
  buffers.beams = std::move(all);
}

void write_irradiance(device::Device& device, std::span<const glm::vec3> q, std::uint32_t number, LevelBuffers& level) {
  check_irradiance(q, number, level.face_count);
  device::write_bytes(device, level.q, std::as_bytes(q));
  device::write_bytes(device, level.beam_q, std::as_bytes(q));
}

}  // namespace quadgraph
