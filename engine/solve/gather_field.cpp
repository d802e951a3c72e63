#include "engine/solve/gather_field.h"

#include <cstring>
#include <utility>

#include "engine/reference/vertex_starts.h"
#include "engine/solve/etendue.h"
#include "engine/solve/moved_bytes.h"
#include "interface/gather/gather_exitance.comp.h"
#include "interface/gather/gather_first.comp.h"
#include "interface/gather/gather_flow.comp.h"
#include "interface/gather/gather_lacking.comp.h"
#include "interface/gather/gather_nodes.comp.h"
#include "interface/gather/gather_phi.comp.h"
#include "interface/gather/gather_scale.comp.h"
#include "interface/gather/gather_single.comp.h"
#include "interface/gather/shared_normals.comp.h"
#include "interface/gather/smooth_normals.comp.h"
#include "interface/gather/uncollided.comp.h"

namespace quadgraph {
namespace {

// Tets that a ray crosses on the way to its end, about as many as in marble at the finest level; for the bytes.
constexpr std::uint64_t tets_per_ray = 8;
constexpr std::uint64_t tet_bytes = sizeof(gpu::TetCell) + sizeof(gpu::Optical);

// Nodes that the means of a vertex look at and take, about as many as where edges are half a mean free path long.
constexpr std::uint64_t boxes_per_mean = 150, nodes_per_mean = 60;

constexpr std::uint64_t faces_per_vertex = 6;
constexpr std::uint64_t face_corner_bytes = sizeof(std::uint32_t) + sizeof(glm::uvec3) + 3 * vec3_bytes;
constexpr std::uint64_t gathered_face_bytes = 2 * sizeof(std::uint32_t) + sizeof(glm::uvec3) + 7 * vec3_bytes;

}  // namespace

GatherField::GatherField(device::Device& device, const Level& level, const BodyTree& tree) {
  const VertexStarts starts = vertex_starts(level, [&] { device.heed(); });
  start_ = device::upload<std::uint32_t>(device, starts.start, "gather/a tet at each vertex");
  nearest_ = device::upload<std::uint32_t>(device, starts.nearest, "gather/nearest surface vertex");
  const auto room = [&](std::uint64_t bytes, const char* name) {
    return device::Buffer(device, bytes, device::Place::device, name);
  };
  solid_on_device_ = room(sizeof(gpu::SolidRef), "gather/body");
  normals_ = room(3 * level.face_count() * vec3_bytes, "gather/smooth normals");
  points_ = room(level.vertex_count() * sizeof(gpu::GatherPoint), "gather/points");
  gathered_ = room(level.face_count() * vec3_bytes, "gather/gathered exitance");
  nodes_ = room((tree.nodes() + level.face_count()) * sizeof(gpu::GatherNode), "gather/nodes");
  scale_ = room(level.surface_vertex_count * sizeof(gpu::GatherScale), "gather/scale");
}

void GatherField::make_room_corrected(device::Device& device, const Level& level) {
  if (lacking_.size() > 0) return;
  const std::uint64_t corners = 4 * level.tet_count();
  lacking_ = {device, corners * vec3_bytes, device::Place::device, "gather/lacking first-scattered light"};
}

void GatherField::make_room_forward(device::Device& device, const Level& level) {
  if (flows_.size() > 0) return;
  const std::uint64_t flows = gpu::GATHER_FLOWS * std::uint64_t{level.vertex_count()};
  flows_ = {device, flows * vec3_bytes, device::Place::device, "gather/flows"};
}

void GatherField::make_room_shared(device::Device& device, const Level& level) {
  if (shared_count_ > 0) return;
  const SharedSurface shared = shared_surface(level);
  shared_count_ = static_cast<std::uint32_t>(shared.vertex.size());
  shared_vertex_ = device::upload<std::uint32_t>(device, shared.vertex, "gather/vertices of shared surfaces");
  shared_offset_ = device::upload<std::uint32_t>(device, shared.offset, "gather/offsets of shared surfaces");
  shared_rim_ = device::upload<glm::uvec2>(device, shared.rim, "gather/rims of shared surfaces");
  shared_normals_ = {device, level.vertex_count() * vec3_bytes, device::Place::device, "gather/shared normals"};
  normals_behind_ = true;
}

void GatherField::record(Workspace& work, const GatherInput& input) {
  record_body(work, input);
  record_points(work, input);
  record_uncollided(work, input);
  if (input.first) record_first(work, input);
  if (input.forward != nullptr) record_flow(work, input);
  record_scale(work, input);
}

void GatherField::record_single(Workspace& work, const GatherInput& input) {
  record_body(work, input);
  work.recorder.fill(points_, 0);
  record_uncollided(work, input);
  const gpu::GatherSinglePush single{.exitance = input.vertex_exitance.address(),
                                     .scale = scale_.address(),
                                     .count = input.level.surface_vertex_count};
  work.recorder.dispatch(work.passes.of(shader::gather_single), single, single.count, "gather scale",
                         single.count * (vec3_bytes + sizeof(gpu::GatherScale)));
}

void GatherField::record_body(Workspace& work, const GatherInput& input) {
  gpu::ForwardLight forward{};
  if (input.forward != nullptr) forward = {flows_.address(), input.forward->beside()};
  gpu::BodyRef body = input.body;
  body.shared_normals = shared_normals_.address();
  write_solid(work.recorder.device(), {body, input.tree.ref(), normals_.address(), forward});
  input.tree.record(work, input.level);
  if (std::exchange(normals_behind_, false)) record_normals(work, input);
}

void GatherField::record_normals(Workspace& work, const GatherInput& input) {
  const gpu::SmoothNormalsPush normals{.body = solid_on_device_.address(),
                                       .face_offset = input.level.face_offset.address(),
                                       .face_incidence = input.level.face_incidence.address(),
                                       .normals = normals_.address()};
  if (shared_count_ > 0) record_shared_normals(work, input);
  const std::uint64_t corners = 3ull * input.level.face_count;
  work.recorder.dispatch(work.passes.of(shader::smooth_normals), normals, static_cast<std::uint32_t>(corners),
                         "smooth normals", corners * (faces_per_vertex * face_corner_bytes + vec3_bytes));
}

void GatherField::record_shared_normals(Workspace& work, const GatherInput& input) {
  const gpu::SharedNormalsPush push{.vertices = input.level.vertices.address(),
                                    .vertex = shared_vertex_.address(),
                                    .offset = shared_offset_.address(),
                                    .rim = shared_rim_.address(),
                                    .normals = shared_normals_.address(),
                                    .count = shared_count_};
  work.recorder.dispatch(work.passes.of(shader::shared_normals), push, shared_count_, "smooth normals",
                         shared_rim_.size() * 4 + shared_count_ * vec3_bytes);
}

void GatherField::write_solid(device::Device& device, const gpu::SolidRef& solid) {
  if (std::memcmp(&solid, &solid_, sizeof(solid)) == 0) return;
  device::write_bytes(device, solid_on_device_, std::as_bytes(std::span(&solid, 1)));
  solid_ = solid;
}

void GatherField::record_points(Workspace& work, const GatherInput& input) {
  const LevelBuffers& level = input.level;
  const gpu::GatherPhiPush phi{.x = input.fluence.x,
                               .to_phi = input.fluence.to_phi,
                               .scale = work.scale.address(),
                               .points = points_.address(),
                               .count = level.vertex_count};
  work.recorder.dispatch(work.passes.of(shader::gather_phi, input.fluence.model), phi, level.vertex_count,
                         "gather points", level.vertex_count * (vec3_bytes + vec3_bytes));
}

void GatherField::record_uncollided(Workspace& work, const GatherInput& input) {
  const LevelBuffers& level = input.level;
  const gpu::UncollidedPush uncollided{.body = solid_on_device_.address(),
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
  work.recorder.dispatch(work.passes.of(shader::uncollided), uncollided, level.vertex_count, "uncollided",
                         level.vertex_count * input.beams.beams.size() * (tets_per_ray * tet_bytes + 2 * vec3_bytes));
}

void GatherField::record_first(Workspace& work, const GatherInput& input) {
  const LevelBuffers& level = input.level;
  const gpu::GatherFirstPush first{.solid = solid_on_device_.address(),
                                   .points = points_.address(),
                                   .deposit = input.first->deposit.address(),
                                   .scale = work.scale.address(),
                                   .lacking = lacking_.address(),
                                   .count = level.tet_count};
  work.recorder.dispatch(
      work.passes.of(shader::gather_first), first, level.tet_count, "gather first",
      level.tet_count * (sizeof(glm::uvec4) + 4 * (sizeof(gpu::GatherPoint) + 2 * vec3_bytes) + sizeof(gpu::Optical)) +
          input.first->deposit.size());
  const gpu::GatherLackingPush lacking{.tets = level.tets.address(),
                                       .tet_offset = input.first->tet_offset.address(),
                                       .tet_incidence = input.first->tet_incidence.address(),
                                       .lacking = lacking_.address(),
                                       .mass = input.first->mass.address(),
                                       .points = points_.address(),
                                       .count = level.vertex_count};
  work.recorder.dispatch(
      work.passes.of(shader::gather_lacking), lacking, level.vertex_count, "gather first",
      lacking_.size() + 4 * level.tet_count * sizeof(glm::uvec4) + level.vertex_count * 3 * vec3_bytes);
}

void GatherField::record_flow(Workspace& work, const GatherInput& input) {
  const LevelBuffers& level = input.level;
  const gpu::GatherFlowPush push{.forward = input.forward->ref().address(),
                                 .points = points_.address(),
                                 .fluence = input.fluence.x,
                                 .flux = input.forward->flux().address(),
                                 .scale = work.scale.address(),
                                 .flows = flows_.address()};
  const std::uint64_t of_tets = 4 * level.tet_count * (sizeof(std::uint32_t) + 7 * FIXED_WORDS * sizeof(std::uint32_t));
  work.recorder.dispatch(work.passes.of(shader::gather_flow), push, level.vertex_count, "gather first",
                         of_tets + level.vertex_count * (sizeof(gpu::GatherPoint) + 10 * vec3_bytes));
}

void GatherField::record_scale(Workspace& work, const GatherInput& input) {
  const LevelBuffers& level = input.level;
  const gpu::GatherExitancePush exitance{.solid = solid_on_device_.address(),
                                         .points = points_.address(),
                                         .exitance = gathered_.address(),
                                         .scale = 0,
                                         .through = input.first ? 1u : 0u};
  work.recorder.dispatch(work.passes.of(shader::gather_exitance), exitance, level.face_count, "gathered exitance",
                         level.face_count * (tets_per_ray * (tet_bytes + sizeof(gpu::GatherPoint)) + vec3_bytes));
  record_nodes(work, input);
  const gpu::GatherScalePush scale{.solid = solid_on_device_.address(),
                                   .face_offset = level.face_offset.address(),
                                   .face_incidence = level.face_incidence.address(),
                                   .gathered = gathered_.address(),
                                   .exitance = input.vertex_exitance.address(),
                                   .nodes = nodes_.address(),
                                   .scale = scale_.address(),
                                   .count = level.surface_vertex_count};
  work.recorder.dispatch(
      work.passes.of(shader::gather_scale), scale, level.surface_vertex_count, "gather scale",
      level.surface_vertex_count *
          (boxes_per_mean * sizeof(gpu::Box) + nodes_per_mean * sizeof(gpu::GatherNode) + sizeof(gpu::GatherScale)));
}

void GatherField::record_nodes(Workspace& work, const GatherInput& input) {
  gpu::GatherNodesPush push{.solid = solid_on_device_.address(),
                            .gathered = gathered_.address(),
                            .exitance = input.vertex_exitance.address(),
                            .nodes = nodes_.address(),
                            .first = 0,
                            .count = 0};
  std::uint64_t bytes = input.level.face_count * gathered_face_bytes;
  input.tree.upwards([&](std::uint32_t first, std::uint32_t count) {
    push.first = first;
    push.count = count;
    work.recorder.dispatch(work.passes.of(shader::gather_nodes), push, count, "gather nodes",
                           bytes + count * sizeof(gpu::GatherNode));
    bytes = count * sizeof(gpu::GatherNode);  // children
  });
}

}  // namespace quadgraph
