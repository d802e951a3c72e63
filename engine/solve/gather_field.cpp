#include "engine/solve/gather_field.h"

#include <cstring>

#include "engine/graph/vertex_starts.h"

namespace quadgraph {
namespace {

constexpr std::uint64_t vec3_bytes = sizeof(glm::vec3);

// Tets that a ray crosses on the way to its end, about as many as in marble at the finest level; for the bytes.
constexpr std::uint64_t tets_per_ray = 8;
constexpr std::uint64_t tet_bytes = 2 * sizeof(std::uint32_t) + vec3_bytes + sizeof(gpu::Optical);

}  // namespace

GatherField::GatherField(vk::Context& context, const Level& level) {
  const VertexStarts starts = vertex_starts(level);
  start_ = vk::upload<std::uint32_t>(context, starts.start, "gather/a tet at each vertex");
  nearest_ = vk::upload<std::uint32_t>(context, starts.nearest, "gather/nearest surface vertex");
  const auto room = [&](std::uint64_t bytes, const char* name) {
    return vk::Buffer(context, bytes, vk::Place::read, name);
  };
  body_on_device_ = room(sizeof(gpu::BodyRef), "gather/body");
  points_ = room(level.vertex_count() * sizeof(gpu::GatherPoint), "gather/points");
  gathered_ = room(level.face_count() * vec3_bytes, "gather/gathered exitance");
  scale_ = room(level.surface_vertex_count * sizeof(gpu::GatherScale), "gather/scale");
}

void GatherField::record(Workspace& work, const GatherInput& input) {
  write_body(work.recorder.context(), input.body);
  record_points(work, input);
  record_scale(work, input);
}

void GatherField::write_body(vk::Context& context, const gpu::BodyRef& body) {
  if (std::memcmp(&body, &body_, sizeof(body)) == 0) return;
  vk::write_bytes(context, body_on_device_, std::as_bytes(std::span(&body, 1)));
  body_ = body;
}

void GatherField::record_points(Workspace& work, const GatherInput& input) {
  const LevelBuffers& level = input.level;
  const gpu::GatherPhiPush phi{.x = input.op.x.address(),
                               .scale = work.scale.address(),
                               .points = points_.address(),
                               .count = level.vertex_count};
  work.recorder.dispatch(work.passes.gather_phi.of(input.op.model), phi, level.vertex_count, "gather points",
                         level.vertex_count * (vec3_bytes + input.op.field_bytes()));
  const gpu::UncollidedPush uncollided{.body = body_on_device_.address(),
                                       .start = start_.address(),
                                       .nearest = nearest_.address(),
                                       .face_offset = level.face_offset.address(),
                                       .face_incidence = level.face_incidence.address(),
                                       .beams = input.beams.on_device.address(),
                                       .beam_q = level.beam_q.address(),
                                       .points = points_.address(),
                                       .beam_count = static_cast<std::uint32_t>(input.beams.beams.size()),
                                       .vertex_count = level.vertex_count,
                                       .surface_vertex_count = level.surface_vertex_count};
  work.recorder.dispatch(work.passes.uncollided, uncollided, level.vertex_count, "uncollided",
                         level.vertex_count * input.beams.beams.size() * (tets_per_ray * tet_bytes + 2 * vec3_bytes));
}

void GatherField::record_scale(Workspace& work, const GatherInput& input) {
  const LevelBuffers& level = input.level;
  const gpu::GatherExitancePush exitance{
      .body = body_on_device_.address(), .points = points_.address(), .exitance = gathered_.address()};
  work.recorder.dispatch(work.passes.gather_exitance, exitance, level.face_count, "gathered exitance",
                         level.face_count * (tets_per_ray * (tet_bytes + sizeof(gpu::GatherPoint)) + vec3_bytes));
  const gpu::GatherScalePush scale{.vertices = level.vertices.address(),
                                   .faces = level.faces.address(),
                                   .face_offset = level.face_offset.address(),
                                   .face_incidence = level.face_incidence.address(),
                                   .gathered = gathered_.address(),
                                   .exitance = input.vertex_exitance.address(),
                                   .scale = scale_.address(),
                                   .count = level.surface_vertex_count};
  const std::uint64_t face_bytes = sizeof(std::uint32_t) + sizeof(glm::uvec3) + 4 * vec3_bytes;
  work.recorder.dispatch(
      work.passes.gather_scale, scale, level.surface_vertex_count, "gather scale",
      3 * level.face_count * face_bytes + level.surface_vertex_count * (vec3_bytes + sizeof(gpu::GatherScale)));
}

}  // namespace quadgraph
