#include "engine/solve/beams.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <string>

#include "engine/graph/error.h"
#include "engine/vk/commands.h"

namespace quadgraph {
namespace {

void check_irradiance(std::span<const glm::vec3> q, std::uint32_t level, std::uint32_t count) {
  if (q.size() != count) {
    throw InputError("irradiance of level " + std::to_string(level) + ": " + std::to_string(q.size()) +
                     " values, one for each of the " + std::to_string(count) + " surface nodes is wanted");
  }
  for (std::size_t i = 0; i < q.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      if (std::isfinite(q[i][c]) && q[i][c] >= 0) continue;
      throw InputError("irradiance of level " + std::to_string(level) + ", surface node " + std::to_string(i) +
                       ", channel " + std::to_string(c) + ": " + std::to_string(q[i][c]) +
                       ", a finite number >= 0 is wanted");
    }
  }
}

}  // namespace

gpu::BeamRecord beam_along(const std::optional<glm::vec3>& direction) {
  if (!direction) return {gpu::BEAM_LAMBERTIAN, glm::vec3(0)};
  const double length = glm::length(glm::dvec3(*direction));
  if (!std::isfinite(length) || length == 0) {
    throw InputError("direction of the light: " + std::to_string(direction->x) + ", " + std::to_string(direction->y) +
                     ", " + std::to_string(direction->z) + ", finite numbers that are not all zero are wanted");
  }
  return {gpu::BEAM_DIRECTIONAL, glm::vec3(glm::dvec3(*direction) / length)};
}

void replace_beams(vk::Context& context, std::span<const gpu::BeamRecord> beams, BeamBuffers& buffers,
                   std::vector<LevelBuffers>& levels) {
  std::vector<gpu::BeamRecord> all(beams.begin(), beams.end());
  all.push_back({gpu::BEAM_MEAN, glm::vec3(0)});
  buffers.records = vk::upload<gpu::BeamRecord>(context, all, "light/beams");
  const bool fits = all.size() == buffers.kinds.size();
  buffers.kinds.clear();
  for (const gpu::BeamRecord& beam : all) buffers.kinds.push_back(beam.kind);
  if (fits) return;
  vk::Commands commands(context);
  for (LevelBuffers& level : levels) {
    const std::uint64_t bytes = all.size() * level.face_count * FACE_QUARTERS * sizeof(glm::vec3);
    level.beam_q = vk::Buffer(context, bytes, vk::Place::device, "light/quarters of the beams");
    commands.fill(level.beam_q, 0);
    commands.fill(level.q, 0);
  }
  commands.submit_and_wait();
}

void write_irradiance(vk::Context& context, std::span<const glm::vec3> q, std::uint32_t number, LevelBuffers& level) {
  check_irradiance(q, number, level.face_count);
  std::vector<glm::vec3> quarters;
  quarters.reserve(FACE_QUARTERS * q.size());
  for (const glm::vec3& value : q) quarters.insert(quarters.end(), FACE_QUARTERS, value);
  vk::write_bytes(context, level.q, std::as_bytes(q));
  vk::write_bytes(context, level.beam_q, std::as_bytes(std::span(quarters)));
}

}  // namespace quadgraph
