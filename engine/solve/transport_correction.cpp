#include "engine/solve/transport_correction.h"

#include <cmath>
#include <utility>

#include "engine/base/error.h"
#include "engine/solve/assembly.h"
#include "engine/solve/level_solver.h"
#include "engine/solve/row_structure.h"
#include "engine/solve/solver_choice.h"
#include "interface/source/right_hand_side_buried.comp.h"
#include "interface/transport/transport_change.comp.h"
#include "interface/transport/transport_exitance.comp.h"
#include "interface/transport/transport_faces.comp.h"
#include "interface/transport/transport_first.comp.h"
#include "interface/transport/transport_fluence.comp.h"
#include "interface/transport/transport_points.comp.h"
#include "interface/transport/transport_step.comp.h"
#include "interface/transport/transport_sweep.comp.h"
#include "interface/transport/transport_weights.comp.h"

namespace quadgraph {
namespace {

constexpr std::uint64_t vec3_bytes = sizeof(glm::vec3);
constexpr std::uint64_t sum_bytes = FIXED_WORDS * sizeof(std::uint32_t);
constexpr std::uint32_t halves = gpu::TRANSPORT_HALVES;

// Rays per point, and per face and half.
constexpr std::uint32_t directions = 16, face_rays = 8;

// Tets that a ray crosses, and what it reads in one; for the bytes.
constexpr std::uint64_t tets_per_ray = 10;
constexpr std::uint64_t segment_bytes = 2 * sizeof(std::uint32_t) + sizeof(gpu::Optical) + 6 * vec3_bytes;

// What is left of what a solve is to find, as a share of it, and its iterations at most, with cycles and without.
constexpr double share_left = 0.01;
constexpr std::uint32_t most_cycles = 12, most_steps = 2000;

// Points are drawn again, so often at most, until what their noise does to the exitance through the solves is no
// larger.
constexpr ErrorEstimate noise_wanted{0.01, 0.02};
constexpr double most_draws = 16;

ErrorEstimate relative(const glm::vec2& square, const glm::vec2& size) {
  const auto root = [](float part, float whole) {
    return whole > 0 ? std::sqrt(std::max(0.0, double{part}) / double{whole}) : 0;
  };
  return {root(square.x, size.x), root(square.y, size.y)};
}

// Of what a sweep has changed, the share that another one would.
constexpr double next_share = 0.15;

double left_after(double change, double noise_before, double noise) {
  const double changed = std::sqrt(std::max(0.0, change * change - noise_before * noise_before));
  return std::hypot(next_share * changed, noise);
}

}  // namespace

ErrorEstimate corrected_error(const CorrectionReport& correction) {
  const CorrectedSweep& last = correction.sweeps.back();
  ErrorEstimate before;
  if (correction.sweeps.size() > 1) before = correction.sweeps.end()[-2].noise;
  return {left_after(last.change.whole, before.whole, last.noise.whole),
          left_after(last.change.unlit, before.unlit, last.noise.unlit)};
}

TransportCorrection::TransportCorrection(device::Device& device, const Level& level) {
  const auto room = [&](std::uint64_t bytes, const char* name, device::Place place = device::Place::device) {
    return device::Buffer(device, bytes, place, "transport/" + std::string(name));
  };
  const TetIncidence tets = quadgraph::tet_incidence(level);
  tet_offset_ = device::upload<std::uint32_t>(device, tets.offset, "transport/tet_offset");
  tet_incidence_ = device::upload<std::uint32_t>(device, tets.tet, "transport/tet_incidence");
  field_ = room(sizeof(gpu::TransportFieldRef), "field");
  deposit_ = room(4 * level.tet_count() * sum_bytes, "deposit at corners");
  first_ = room(4 * level.tet_count() * vec3_bytes, "first scattered");
  weights_ = room(level.tet_count() * sizeof(glm::vec2), "weights");
  total_ = room(sizeof(float), "total weight");
  drawn_ = room(sizeof(std::uint32_t), "points drawn");
  segments_ = room(sizeof(std::uint32_t), "segments");
  segments_on_host_ = room(sizeof(std::uint32_t), "segments, read back", device::Place::host);
  load_ = room(2 * halves * level.vertex_count() * sum_bytes, "load");
  gathered_ = room(halves * level.face_count() * vec3_bytes, "gathered exitance");
  for (std::uint32_t half = 0; half < halves; ++half) {
    right_side_[half] = room(level.vertex_count() * vec3_bytes, "b");
    change_[half] = room(level.vertex_count() * vec3_bytes, "change of fluence");
  }
  fluence_ = room(level.vertex_count() * vec3_bytes, "fluence");
  exitance_ = room(level.face_count() * vec3_bytes, "exitance");
  statistics_ = room(2 * sizeof(gpu::TransportChange), "change");
  statistics_on_host_ = room(2 * sizeof(gpu::TransportChange), "change, read back", device::Place::host);
}

// Of each tet at most one point more than it weighs is drawn: ten standard deviations of their number are left.
void TransportCorrection::make_room(device::Device& device, std::uint32_t points) {
  points_wanted_ = points;
  const std::uint32_t room = points + points / 8 + 1024;
  if (room_ == room) return;
  room_ = room;
  points_ = {device, room * sizeof(gpu::TransportPoint), device::Place::device, "transport/points"};
}

void TransportCorrection::record_start(const CorrectionParts& parts, const WalkTask& task) {
  Workspace& work = parts.work;
  const LevelBuffers& level = parts.level;
  const gpu::TransportFieldRef field{.body = parts.walk.body(level, task.eta, task.even),
                                     .fluence = fluence_.address(),
                                     .first = first_.address(),
                                     .segments = segments_.address()};
  device::write_bytes(work.recorder.device(), field_, std::as_bytes(std::span(&field, 1)));
  work.recorder.fill(segments_, 0);
  work.recorder.copy(parts.results.exitance(), exitance_, exitance_.size());
  parts.walk.record_corners(work, level, parts.beams, task, deposit_);
  const gpu::TransportFirstPush first{.vertices = level.vertices.address(),
                                      .tets = level.tets.address(),
                                      .deposit = deposit_.address(),
                                      .first = first_.address(),
                                      .count = level.tet_count};
  work.recorder.dispatch(work.passes.of(shader::transport_first), first, level.tet_count, "transport start",
                         deposit_.size() + first_.size() + level.tet_count * (sizeof(glm::uvec4) + 4 * vec3_bytes));
  const OperatorBuffers& op = parts.solved.op;
  const gpu::TransportFluencePush fluence{
      .x = op.x.address(), .to_phi = op.to_phi.address(), .fluence = fluence_.address(), .count = level.vertex_count};
  work.recorder.dispatch(work.passes.of(shader::transport_fluence, op.model), fluence, level.vertex_count,
                         "transport start", level.vertex_count * (op.field_bytes() + vec3_bytes));
  const gpu::TransportWeightsPush weights{.vertices = level.vertices.address(),
                                          .tets = level.tets.address(),
                                          .optical = level.optical.address(),
                                          .nearest = parts.nearest.address(),
                                          .weights = weights_.address(),
                                          .total = total_.address(),
                                          .reduction = work.reduction.address(),
                                          .count = level.tet_count,
                                          .even = level.even ? 1u : 0u};
  work.recorder.dispatch(work.passes.of(shader::transport_weights), weights, level.tet_count, "transport start",
                         level.tet_count * (2 * sizeof(glm::uvec4) + 8 * vec3_bytes + sizeof(gpu::Optical)));
}

void TransportCorrection::record_points(const CorrectionParts& parts) {
  Workspace& work = parts.work;
  work.recorder.fill(drawn_, 0);
  const gpu::TransportPointsPush push{.weights = weights_.address(),
                                      .total = total_.address(),
                                      .drawn = drawn_.address(),
                                      .points = points_.address(),
                                      .tet_count = parts.level.tet_count,
                                      .seed = ++seed_,
                                      .wanted = static_cast<float>(points_wanted_) / halves,
                                      .room = room_};
  work.recorder.dispatch(work.passes.of(shader::transport_points), push, parts.level.tet_count, "transport points",
                         weights_.size() + points_.size());
}

void TransportCorrection::record_sweep(const CorrectionParts& parts) {
  Workspace& work = parts.work;
  const gpu::TransportSweepPush push{.field = field_.address(),
                                     .drawn = drawn_.address(),
                                     .points = points_.address(),
                                     .load = load_.address(),
                                     .room = room_,
                                     .directions = directions,
                                     .vertex_count = parts.level.vertex_count};
  work.recorder.dispatch(work.passes.of(shader::transport_sweep), push, room_, "transport sweep",
                         std::uint64_t{points_wanted_} * directions * tets_per_ray * segment_bytes);
}

void TransportCorrection::record_exitance(const CorrectionParts& parts) {
  Workspace& work = parts.work;
  const gpu::TransportExitancePush push{
      .field = field_.address(), .exitance = gathered_.address(), .rays = face_rays, .seed = ++seed_};
  const std::uint64_t samples = std::uint64_t{halves} * parts.level.face_count;
  work.recorder.dispatch(work.passes.of(shader::transport_exitance), push, samples, "transport exitance",
                         samples * face_rays * tets_per_ray * segment_bytes);
}

void TransportCorrection::record_load(const CorrectionParts& parts, OperatorBuffers& op, std::uint32_t half) {
  Workspace& work = parts.work;
  const std::uint64_t bytes = op.count * sum_bytes, added = load_.address() + 2 * half * bytes;
  const gpu::RightHandSideBuriedPush push{.deposit = added,
                                          .taken = added + bytes,
                                          .vertices = parts.level.vertices.address(),
                                          .tets = parts.level.tets.address(),
                                          .side = op.right_hand_side(work.reduction),
                                          .count = op.count,
                                          .deposit_count = op.count,
                                          .per_volume = 0,
                                          .share = 1.0f / static_cast<float>(draws_)};
  work.recorder.dispatch(work.passes.of(shader::right_hand_side_buried, op.model, op.format), push, op.count,
                         "right-hand side", op.count * (op.block_bytes() + op.field_bytes()) + 2 * bytes);
}

// A delta = b of one half. The operator lends its rows and vectors; b and x of its own solution stay what they are.
void TransportCorrection::solve(const CorrectionParts& parts, std::uint32_t half) {
  OperatorBuffers& op = parts.operators.at(correction_key, 0);
  std::swap(op.b, right_side_[half]);
  std::swap(op.x, change_[half]);
  const SolverKind kind = possible_solver(parts.operators, correction_key, SolverKind::fmg_pcg).solver;
  const bool cycles = rules_of(kind).cycles;
  const LevelTask task{.solver = kind,
                       .boundary = parts.boundary,
                       .tolerance = share_left,
                       .max_iterations = cycles ? most_cycles : most_steps,
                       .smoothing = rules_of(kind).smoothing};
  LevelSolver solver(parts.work, parts.operators, correction_key, 0, task);
  record_load(parts, op, half);
  parts.work.recorder.fill(op.x, 0);
  if (cycles) {
    solver.record_start();
    solver.record(most_cycles);
    solver.record_state();
    parts.work.recorder.submit();
    solver.take();
  } else {
    solver.run();
  }
  std::swap(op.b, right_side_[half]);
  std::swap(op.x, change_[half]);
}

// Statistics with all noise, then with that of the solves alone.
void TransportCorrection::record_change(const CorrectionParts& parts) {
  Workspace& work = parts.work;
  const LevelBuffers& level = parts.level;
  gpu::TransportChangePush push{.vertices = level.vertices.address(),
                                .faces = level.faces.address(),
                                .face_offset = level.face_offset.address(),
                                .face_incidence = level.face_incidence.address(),
                                .share = parts.operators.at(correction_key, 0).surface_share.address(),
                                .scale = work.scale.address(),
                                .gathered = gathered_.address(),
                                .change_a = change_[0].address(),
                                .change_b = change_[1].address(),
                                .exitance = exitance_.address(),
                                .change = statistics_.address(),
                                .reduction = work.reduction.address(),
                                .count = level.surface_vertex_count,
                                .face_count = level.face_count,
                                .k11 = static_cast<float>(parts.boundary.k11),
                                .solves = 0};
  for (; push.solves < 2; ++push.solves) {
    work.recorder.dispatch(work.passes.of(shader::transport_change), push, level.surface_vertex_count,
                           "transport change", 3 * level.face_count * (sizeof(glm::uvec3) + 12 * vec3_bytes));
    push.change += sizeof(gpu::TransportChange);
  }
  work.recorder.copy(statistics_, statistics_on_host_, statistics_.size());
}

void TransportCorrection::record_faces(const CorrectionParts& parts) {
  Workspace& work = parts.work;
  const LevelBuffers& level = parts.level;
  const gpu::TransportFacesPush faces{.faces = level.faces.address(),
                                      .face_kinds = level.face_kind.address(),
                                      .scale = work.scale.address(),
                                      .gathered = gathered_.address(),
                                      .change_a = change_[0].address(),
                                      .change_b = change_[1].address(),
                                      .exitance = exitance_.address(),
                                      .count = level.face_count,
                                      .k11 = static_cast<float>(parts.boundary.k11)};
  work.recorder.dispatch(work.passes.of(shader::transport_faces), faces, level.face_count, "transport change",
                         level.face_count * (sizeof(glm::uvec3) + 9 * vec3_bytes));
}

void TransportCorrection::record_step(const CorrectionParts& parts) {
  Workspace& work = parts.work;
  const LevelBuffers& level = parts.level;
  const gpu::TransportStepPush push{.vertices = level.vertices.address(),
                                    .tets = level.tets.address(),
                                    .optical = level.optical.address(),
                                    .tet_offset = tet_offset_.address(),
                                    .tet_incidence = tet_incidence_.address(),
                                    .load_a = right_side_[0].address(),
                                    .load_b = right_side_[1].address(),
                                    .change_a = change_[0].address(),
                                    .change_b = change_[1].address(),
                                    .fluence = fluence_.address(),
                                    .count = level.vertex_count,
                                    .even = level.even ? 1u : 0u};
  work.recorder.dispatch(
      work.passes.of(shader::transport_step), push, level.vertex_count, "transport step",
      4 * level.tet_count * (sizeof(glm::uvec4) + 4 * vec3_bytes) + 6 * level.vertex_count * vec3_bytes);
}

// So many draws of points more; then the solves, and what they say.
void TransportCorrection::draw(const CorrectionParts& parts, std::uint32_t draws) {
  for (std::uint32_t k = 0; k < draws; ++k) {
    record_points(parts);
    record_sweep(parts);
  }
  draws_ += draws;
  for (std::uint32_t half = 0; half < halves; ++half) solve(parts, half);
  record_change(parts);
  parts.work.recorder.submit();
}

CorrectedSweep TransportCorrection::sweep(const CorrectionParts& parts) {
  record_exitance(parts);
  parts.work.recorder.fill(load_, 0);
  draws_ = 0;
  draw(parts, 1);
  const std::span<const gpu::TransportChange> found = statistics_on_host_.mapped_as<gpu::TransportChange>();
  const ErrorEstimate noise = relative(found[1].noise, found[1].size);
  const double excess = std::max(noise.whole / noise_wanted.whole, noise.unlit / noise_wanted.unlit);
  const double wanted = std::min(std::ceil(excess * excess), most_draws);
  if (wanted > 1) draw(parts, static_cast<std::uint32_t>(wanted) - 1);
  record_faces(parts);
  record_step(parts);
  if (!std::isfinite(found[0].change.x) || !std::isfinite(found[0].noise.x) || !std::isfinite(found[0].size.x)) {
    throw SolverError("transport correction: met a value that is not finite");
  }
  return {relative(found[0].change, found[0].size), relative(found[0].noise, found[0].size),
          static_cast<double>(draws_) * points_wanted_};
}

CorrectionReport TransportCorrection::run(const CorrectionParts& parts, const SolveOptions& options,
                                          const WalkTask& task) {
  record_start(parts, task);
  seed_ = 0;
  CorrectionReport report;
  for (std::uint32_t k = 0; k < options.sweeps; ++k) report.sweeps.push_back(sweep(parts));
  parts.work.recorder.copy(segments_, segments_on_host_, segments_.size());
  parts.work.recorder.submit();
  report.segments = segments_on_host_.mapped_as<std::uint32_t>()[0];
  return report;
}

}  // namespace quadgraph
