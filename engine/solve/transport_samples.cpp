#include "engine/solve/transport_samples.h"

#include <algorithm>

#include "engine/reference/vertex_starts.h"
#include "engine/solve/moved_bytes.h"
#include "engine/solve/row_structure.h"
#include "interface/transport/transport_books.comp.h"
#include "interface/transport/transport_carry.comp.h"
#include "interface/transport/transport_exitance.comp.h"
#include "interface/transport/transport_fluence.comp.h"
#include "interface/transport/transport_leaving.comp.h"
#include "interface/transport/transport_mass.comp.h"
#include "interface/transport/transport_points.comp.h"
#include "interface/transport/transport_source.comp.h"
#include "interface/transport/transport_totals.comp.h"
#include "interface/transport/transport_walk.comp.h"
#include "interface/transport/transport_weights.comp.h"

namespace quadgraph {
namespace {

// Rays a face of light whose directions are known. Fewer are an error that no sweep mends, in dark bodies the largest.
constexpr std::uint32_t rays_at_rest = 16, rays_in_motion = 4;

// Draws before the tets take their turns again: while a float tells them apart.
constexpr std::uint32_t draws_apart = 1u << 16;

// Passes between the numbers of one seed and the next, and draws.
constexpr std::uint32_t passes_between = 1000003, draws_between = 61;

// Sums of each of the WALK_SUMS of what is gathered.
constexpr std::uint32_t gather_sums = 4;

}  // namespace

std::uint32_t entering_rays(bool mean_rays) {
  return mean_rays ? rays_in_motion : rays_at_rest;
}

TransportSamples::TransportSamples(device::Device& device, const Level& level) {
  const auto room = [&](std::uint64_t bytes, const char* name, device::Place place = device::Place::device) {
    return device::Buffer(device, bytes, place, "transport/" + std::string(name));
  };
  const std::uint64_t vertices = level.vertex_count() * vec3_bytes, corners = 4 * level.tet_count() * vec3_bytes;
  field_ = room(sizeof(gpu::TransportFieldRef), "field");
  deposit_ = room(4 * level.tet_count() * sum_bytes, "deposit at corners");
  source_before_ = room(corners, "source, before");
  sources_ = room(level.tet_count() * sizeof(gpu::TetSource), "sources");
  fluence_ = room(vertices, "fluence");
  fluence_before_ = room(vertices, "fluence, before");
  fluence_seen_ = room(vertices, "fluence, seen");
  added_ = room(vertices, "fluence, added");
  unit_ = room(vec3_bytes, "scale, before");
  weights_ = room(level.tet_count() * sizeof(glm::vec2), "weights");
  total_ = room(sizeof(float), "total weight");
  const std::vector<std::uint32_t> boundary = nearest_boundary(level, [&] { device.heed(); });
  if (!boundary.empty()) boundary_ = device::upload<std::uint32_t>(device, boundary, "transport/nearest boundary");
  drawn_ = room(sizeof(std::uint32_t), "points drawn");
  load_ = room(2 * gpu::TRANSPORT_HALVES * level.vertex_count() * sum_bytes, "load");
  gathered_ = room(gpu::TRANSPORT_HALVES * level.face_count() * vec3_bytes, "gathered exitance");
  const TetIncidence tets = quadgraph::tet_incidence(level, [&] { device.heed(); });
  tet_offset_ = device::upload<std::uint32_t>(device, tets.offset, "transport/tet_offset");
  tet_incidence_ = device::upload<std::uint32_t>(device, tets.tet, "transport/tet_incidence");
  mass_ = room(vertices, "mass");
  for (device::Buffer& swept : swept_) swept = room(vertices, "swept");
  point_sums_ = room(2 * gpu::TRANSPORT_HALVES * gpu::WALK_SUMS * sum_bytes, "power of the points");
  books_ = room(sizeof(gpu::TransportBook), "books");
  segments_ = room(sizeof(std::uint32_t), "segments");
  walk_sums_ = room(gpu::TRANSPORT_WALK_SUMS * gpu::WALK_SUMS * sum_bytes, "power of the walk");
  gather_sums_ = room(gather_sums * gpu::WALK_SUMS * sum_bytes, "power gathered");
  segments_on_host_ = room(segments_.size(), "segments, read back", device::Place::host);
  walk_sums_on_host_ = room(walk_sums_.size(), "power of the walk, read back", device::Place::host);
  books_on_host_ = room(books_.size(), "books, read back", device::Place::host);
}

void TransportSamples::make_room(device::Device& device, std::uint32_t points) {
  points_wanted_ = points;
  const std::uint32_t room = room_for(points);
  if (room_ == room) return;
  room_ = room;
  points_ = {device, room * sizeof(gpu::TransportPoint), device::Place::device, "transport/points"};
}

void TransportSamples::make_room_forward(device::Device& device, const Level& level) {
  if (!forward_) forward_.emplace(device, level);
}

void TransportSamples::make_room_apart(const TransportParts& parts) {
  if (source_apart_.size() > 0) return;
  device::Device& device = parts.work.recorder.device();
  source_apart_ = {device, source_before_.size(), device::Place::device, "transport/source, apart"};
  fluence_apart_ = {device, fluence_.size(), device::Place::device, "transport/fluence, apart"};
}

void TransportSamples::write_field(const TransportParts& parts, const WalkTask& task, bool apart) {
  gpu::BodyRef body = parts.walk.body(parts.level, task.even);
  body.optical = optical(parts).address();
  const gpu::TransportFieldRef field{.body = body,
                                     .tree = parts.tree.ref(),
                                     .sources = sources_.address(),
                                     .sky = parts.level.sky.address(),
                                     .segments = segments_.address(),
                                     .source_before = apart ? source_apart_.address() : 0,
                                     .optical_before = apart ? optical_before_.address() : 0,
                                     .flows = parts.forward() ? forward_->flows().address() : 0,
                                     .beside = parts.forward() ? forward_->beside() : gpu::BesidePeak{},
                                     .even_before = even_before_ ? 1u : 0u,
                                     .outside = parts.outside ? 1u : 0u};
  device::write_bytes(parts.work.recorder.device(), field_, std::as_bytes(std::span(&field, 1)));
}

void TransportSamples::record_start(const TransportParts& parts, const WalkTask& task, const OperatorBuffers& op,
                                    const TransportShares& shares) {
  Workspace& work = parts.work;
  if (shares.apart) make_room_apart(parts);
  if (parts.forward()) forward_->record_start(forward_parts(parts), parts.g);
  write_field(parts, task, shares.apart);
  parts.tree.record(work, parts.level);
  work.recorder.fill(segments_, 0);
  record_walk(parts, task);
  record_mass(parts);
  record_fluence(parts, op, {.keep = shares.ahead ? 1.0f : 0.0f, .taken = 0, .swept = 0});
  if (parts.forward()) {
    forward_->record_sooner(forward_parts(parts), parts.walk, mass_, fluence_, 1);
    forward_->record_flux(forward_parts(parts), fluence_, shares.ahead);
  }
  record_weights(parts);
}

void TransportSamples::record_fluence(const TransportParts& parts, const OperatorBuffers& op,
                                      const FluenceShares& shares) {
  Workspace& work = parts.work;
  const gpu::TransportFluencePush fluence{.x = op.x.address(),
                                          .to_phi = op.to_phi.address(),
                                          .fluence = fluence_.address(),
                                          .added = added_.address(),
                                          .unit = unit_.address(),
                                          .scale = work.scale.address(),
                                          .mass = mass_.address(),
                                          .first = parts.walk.first_deposit().address(),
                                          .all = parts.walk.deposit(Method::fem).address(),
                                          .count = parts.level.vertex_count,
                                          .keep = shares.keep,
                                          .taken = shares.taken,
                                          .swept = shares.swept};
  work.recorder.dispatch(work.passes.of(shader::transport_fluence, op.model), fluence, parts.level.vertex_count,
                         "transport start",
                         parts.level.vertex_count * (op.field_bytes() + 4 * vec3_bytes + 2 * sum_bytes));
}

void TransportSamples::record_mass(const TransportParts& parts) {
  Workspace& work = parts.work;
  const LevelBuffers& level = parts.level;
  const gpu::TransportMassPush push{.vertices = level.vertices.address(),
                                    .tets = level.tets.address(),
                                    .optical = optical(parts).address(),
                                    .etendue = level.etendue.address(),
                                    .tet_offset = tet_offset_.address(),
                                    .tet_incidence = tet_incidence_.address(),
                                    .mass = mass_.address(),
                                    .count = level.vertex_count,
                                    .even = level.even ? 1u : 0u};
  work.recorder.dispatch(work.passes.of(shader::transport_mass), push, level.vertex_count, "transport start",
                         4 * level.tet_count * (sizeof(glm::uvec4) + 4 * vec3_bytes) + mass_.size());
}

void TransportSamples::record_walk(const TransportParts& parts, const WalkTask& task) {
  Workspace& work = parts.work;
  const LevelBuffers& level = parts.level;
  work.recorder.fill(deposit_, 0);
  work.recorder.fill(walk_sums_, 0);
  gpu::TransportWalkPush push{.field = field_.address(),
                              .beam = parts.beams.on_device.address(),
                              .beam_q = level.beam_q.address(),
                              .scale = work.scale.address(),
                              .deposit = deposit_.address(),
                              .sums = walk_sums_.address(),
                              .towards = parts.forward() ? forward_->towards().address() : 0,
                              .leaving = parts.forward() ? forward_->leaving().address() : 0,
                              .rays = 1,
                              .sky = 0,
                              .first = 0,
                              .deposits = gpu::WALK_CORNERS | (task.mean_rays ? gpu::WALK_TO_MEAN : 0u)};
  for (const gpu::Beam& beam : parts.beams.beams) {
    const std::uint32_t kind = beam.way.kind;
    if (kind == gpu::BEAM_MEAN) continue;
    push.sky = beam.floats == gpu::BEAM_FACE || beam.picture != 0 ? 1 : 0;
    const bool directed = push.sky == 1 || kind != gpu::BEAM_LAMBERTIAN;
    push.rays = directed ? entering_rays(task.mean_rays) : rays_of(kind, task.mean_rays);
    push.first = task.seed * push.rays * level.face_count;  // where those of the seed before have come to
    work.recorder.dispatch(work.passes.of(shader::transport_walk), push, std::uint64_t{level.face_count} * push.rays,
                           "transport walk", walk_bytes(level, push.rays));
    push.beam += sizeof(gpu::Beam);
  }
}

void TransportSamples::record_weights(const TransportParts& parts) {
  Workspace& work = parts.work;
  const LevelBuffers& level = parts.level;
  const gpu::TransportWeightsPush weights{.vertices = level.vertices.address(),
                                          .tets = level.tets.address(),
                                          .optical = level.optical.address(),
                                          .etendue = level.etendue.address(),
                                          .nearest = parts.nearest.address(),
                                          .boundary = boundary_.size() > 0 ? boundary_.address() : 0,
                                          .tet_offset = tet_offset_.address(),
                                          .tet_incidence = tet_incidence_.address(),
                                          .weights = weights_.address(),
                                          .total = total_.address(),
                                          .reduction = work.reduction.address(),
                                          .count = level.tet_count,
                                          .even = level.even ? 1u : 0u};
  work.recorder.dispatch(work.passes.of(shader::transport_weights), weights, level.tet_count, "transport start",
                         level.tet_count * (2 * sizeof(glm::uvec4) + 8 * vec3_bytes + sizeof(gpu::Optical)));
}

void TransportSamples::record_carried(const TransportParts& parts, const BodyBoundaries& boundaries) {
  Workspace& work = parts.work;
  const LevelBuffers& level = parts.level;
  const gpu::TransportCarryPush push{.faces = level.faces.address(),
                                     .face_kinds = level.face_kind.address(),
                                     .boundaries = boundaries.on_device,
                                     .fluence = fluence_.address(),
                                     .fluence_before = fluence_before_.address(),
                                     .unit = unit_.address(),
                                     .scale = work.scale.address(),
                                     .gathered = gathered_.address(),
                                     .count = level.face_count};
  work.recorder.dispatch(work.passes.of(shader::transport_carry), push, level.face_count, "transport source",
                         2 * gathered_.size() + level.face_count * (sizeof(glm::uvec3) + 6 * vec3_bytes));
}

void TransportSamples::record_source(const TransportParts& parts, const TransportShares& shares) {
  Workspace& work = parts.work;
  const LevelBuffers& level = parts.level;
  const gpu::TransportSourcePush push{.weights = weights_.address(),
                                      .tets = level.tets.address(),
                                      .optical = optical(parts).address(),
                                      .fluence = fluence_.address(),
                                      .deposit = deposit_.address(),
                                      .fluence_before = fluence_before_.address(),
                                      .source_before = source_before_.address(),
                                      .unit = unit_.address(),
                                      .scale = work.scale.address(),
                                      .fluence_seen = fluence_seen_.address(),
                                      .fluence_apart = shares.apart ? fluence_apart_.address() : 0,
                                      .source_apart = shares.apart ? source_apart_.address() : 0,
                                      .sources = sources_.address(),
                                      .vertex_count = level.vertex_count,
                                      .tet_count = level.tet_count,
                                      .even = level.even ? 1u : 0u,
                                      .share = shares.present,
                                      .keep = shares.before};
  work.recorder.dispatch(work.passes.of(shader::transport_source), push, std::max(level.tet_count, level.vertex_count),
                         "transport source",
                         4 * fluence_.size() + deposit_.size() + 3 * source_before_.size() +
                             level.tet_count * (sizeof(glm::uvec4) + sizeof(glm::vec2) + 4 * vec3_bytes));
  if (parts.forward()) forward_->record_flow(forward_parts(parts), shares.present, shares.before);
}

void TransportSamples::begin_seeds(std::uint32_t seed) {
  seed_ = seed * passes_between;
  draw_ = seed * draws_between;
}

void TransportSamples::record_exitance(const TransportParts& parts, std::uint32_t rays, float known) {
  Workspace& work = parts.work;
  work.recorder.fill(gather_sums_, 0);
  const gpu::TransportExitancePush push{.field = field_.address(),
                                        .exitance = gathered_.address(),
                                        .sums = gather_sums_.address(),
                                        .unit = unit_.address(),
                                        .scale = work.scale.address(),
                                        .rays = rays,
                                        .seed = ++seed_,
                                        .keep = known};
  const std::uint64_t samples = std::uint64_t{gpu::TRANSPORT_HALVES} * parts.level.face_count;
  work.recorder.dispatch(work.passes.of(shader::transport_exitance), push, samples, "transport exitance",
                         samples * rays * tets_per_ray * segment_bytes);
}

void TransportSamples::record_no_load(const TransportParts& parts) {
  parts.work.recorder.fill(point_sums_, 0);
  parts.work.recorder.fill(load_, 0);
  if (parts.forward()) forward_->record_nothing_found(forward_parts(parts));
  record_totals(parts);
}

void TransportSamples::record_draw(const TransportParts& parts, std::uint32_t directions, double share) {
  Workspace& work = parts.work;
  const auto wanted = static_cast<std::uint32_t>(share * points_wanted_);
  work.recorder.fill(drawn_, 0);
  const gpu::TransportPointsPush points{.weights = weights_.address(),
                                        .total = total_.address(),
                                        .drawn = drawn_.address(),
                                        .points = points_.address(),
                                        .tet_count = parts.level.tet_count,
                                        .draw = draw_++ % draws_apart,
                                        .wanted = static_cast<float>(wanted) / gpu::TRANSPORT_HALVES,
                                        .room = room_};
  work.recorder.dispatch(work.passes.of(shader::transport_points), points, parts.level.tet_count, "transport points",
                         weights_.size() + points_.size());
  record_sweep(parts, directions, wanted);
}

void TransportSamples::record_totals(const TransportParts& parts) {
  Workspace& work = parts.work;
  const LevelBuffers& level = parts.level;
  const gpu::TransportTotalsPush totals{.vertices = level.vertices.address(),
                                        .tets = level.tets.address(),
                                        .optical = optical(parts).address(),
                                        .etendue = level.etendue.address(),
                                        .fluence = fluence_.address(),
                                        .source = source_before_.address(),
                                        .books = books_.address(),
                                        .reduction = work.reduction.address(),
                                        .count = level.tet_count,
                                        .even = level.even ? 1u : 0u};
  work.recorder.dispatch(work.passes.of(shader::transport_totals), totals, level.tet_count, "transport books",
                         source_before_.size() + level.tet_count * (sizeof(glm::uvec4) + 8 * vec3_bytes));
  const gpu::TransportLeavingPush leaving{.vertices = level.vertices.address(),
                                          .faces = level.faces.address(),
                                          .gathered = gathered_.address(),
                                          .books = books_.address(),
                                          .reduction = work.reduction.address(),
                                          .count = level.face_count};
  work.recorder.dispatch(work.passes.of(shader::transport_leaving), leaving, level.face_count, "transport books",
                         gathered_.size() + level.face_count * (sizeof(glm::uvec3) + 3 * vec3_bytes));
}

void TransportSamples::record_books(const TransportParts& parts, float share, float known) {
  Workspace& work = parts.work;
  const gpu::TransportBooksPush push{.books = books_.address(),
                                     .points = point_sums_.address(),
                                     .again = gather_sums_.address(),
                                     .unit = unit_.address(),
                                     .scale = work.scale.address(),
                                     .share = share,
                                     .keep = known};
  work.recorder.dispatch(work.passes.of(shader::transport_books), push, 1, "transport books",
                         point_sums_.size() + gather_sums_.size());
}

}  // namespace quadgraph
