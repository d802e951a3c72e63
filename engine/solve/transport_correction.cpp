#include "engine/solve/transport_correction.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "engine/base/error.h"
#include "engine/solve/assembly.h"
#include "engine/solve/level_solver.h"
#include "engine/solve/moved_bytes.h"
#include "engine/solve/solver_choice.h"
#include "engine/solve/surface_share.h"
#include "interface/transport/transport_change.comp.h"
#include "interface/transport/transport_faces.comp.h"
#include "interface/transport/transport_load.comp.h"

namespace quadgraph {
namespace {

// What is left of what a solve is to find, as a share of it, and its iterations at most, with cycles and without.
constexpr double share_left = 0.01;
constexpr std::uint32_t most_cycles = 12, most_steps = 2000;

// What the exitance may be off by after the last sweep, where nobody says how many or how far: by the noise of the
// samples, and by what another sweep would change; sweeps at most. Of an error that is asked for, the share of each.
constexpr ErrorEstimate error_wanted{.whole = 0.008, .unlit = 0.016};
constexpr double share_of_error = 0.45;
constexpr std::uint32_t most_sweeps = 4;

// Directions per point, and rays per face and half; draws of points at most, or more while all of them cross so many
// segments for each tet.
constexpr std::uint32_t rest_directions = 12, rest_rays = 8, motion_directions = 8, motion_rays = 1;
constexpr double most_draws = 16, segments_per_tet = 300;

// Noise that the solves of a frame in motion may have. Its points are halved, down to a share, where half as many would
// do, with room for what the memory of frames hides: of a thin body the rays are long, and few points tell enough.
constexpr ErrorEstimate motion_noise_wanted{.whole = 0.005, .unlit = 0.008};
constexpr double halving_excess = 0.3, least_drawn = 0.125;

// Of what is known from the frames before, the least that the newest has a say in; frames that a solve at rest is
// worth.
constexpr float least_share = 0.15f;
constexpr std::uint32_t frames_of_rest = 9;

// Noise of a frame beyond which nothing of it is known to the next: its samples would find more of that noise than of
// the body, and make it grow.
constexpr double most_noise_known = 0.3;

ErrorEstimate relative(const glm::vec3& square, const glm::vec3& size) {
  const auto root = [](float part, float whole) {
    return whole > 0 ? std::sqrt(std::max(0.0, double{part}) / double{whole}) : 0;
  };
  return {root(square.x, size.x), root(square.y, size.y), root(square.z, size.z)};
}

// The error is that of means over patches, so many on the whole surface; about so many faces are around a vertex. What
// faces gather is off each by itself, what the solves find is not.
constexpr double patches = 250, faces_around = 6;

double of_patches(double at_vertices, double of_solves, double faces) {
  const double gathered = std::max(0.0, at_vertices * at_vertices - of_solves * of_solves);
  return std::sqrt(of_solves * of_solves + gathered * std::min(1.0, faces_around * patches / faces));
}

ErrorEstimate wanted(const SolveOptions& options) {
  const double share = share_of_error * options.error;
  return options.error > 0 ? ErrorEstimate{.whole = share, .unlit = share} : error_wanted;
}

// So many times the points would leave the noise that is wanted of what they add.
double excess_of(const ErrorEstimate& noise, const ErrorEstimate& before, const ErrorEstimate& wanted) {
  const auto excess = [](double all, double first, double most) { return (all * all - first * first) / (most * most); };
  return std::max(excess(noise.whole, before.whole, wanted.whole), excess(noise.unlit, before.unlit, wanted.unlit));
}

// What all sweeps have changed.
ErrorEstimate change_of_all(const CorrectionReport& done) {
  ErrorEstimate all;
  for (const CorrectedSweep& sweep : done.sweeps) {
    all = by_parts([](double before, double change) { return std::hypot(before, change); }, all, sweep.change);
  }
  return all;
}

// Whether another sweep would change less than is wanted, or than the noise.
bool last_of_all(const CorrectionReport& done, const ErrorEstimate& wanted) {
  const CorrectedSweep& last = done.sweeps.back();
  const double share = share_left_by(done);
  return share * last.change.whole <= std::max(wanted.whole, last.noise.whole) &&
         share * last.change.unlit <= std::max(wanted.unlit, last.noise.unlit);
}

}  // namespace

double extinction_change(std::span<const gpu::Optical> before, std::span<const gpu::Optical> now) {
  if (before.size() != now.size()) return 1;
  double change = 0, size = 0;
  for (std::size_t i = 0; i < now.size(); ++i) {
    const glm::vec3 was = before[i].sigma_s_prime + before[i].sigma_a;
    const glm::dvec3 step = glm::abs(glm::dvec3(now[i].sigma_s_prime + now[i].sigma_a) - glm::dvec3(was));
    change += step.x + step.y + step.z;
    size += static_cast<double>(was.x) + static_cast<double>(was.y) + static_cast<double>(was.z);
  }
  return size > 0 ? change / size : 1;
}

TransportCorrection::TransportCorrection(device::Device& device, const Level& level) : samples_(device, level) {
  const auto room = [&](std::uint64_t bytes, const char* name, device::Place place = device::Place::device) {
    return device::Buffer(device, bytes, place, "transport/" + std::string(name));
  };
  for (std::uint32_t half = 0; half < gpu::TRANSPORT_HALVES; ++half) {
    right_side_[half] = room(level.vertex_count() * vec3_bytes, "b");
    known_[half] = room(level.vertex_count() * vec3_bytes, "b, before");
    change_[half] = room(level.vertex_count() * vec3_bytes, "change of fluence");
  }
  halves_ = room(gpu::TRANSPORT_HALVES * level.face_count() * vec3_bytes, "exitance of both halves");
  exitance_ = room(level.face_count() * vec3_bytes, "exitance");
  statistics_ = room(2 * sizeof(gpu::TransportChange), "change");
  statistics_on_host_ = room(2 * sizeof(gpu::TransportChange), "change, read back", device::Place::host);
}

void TransportCorrection::record_load(const CorrectionParts& parts, OperatorBuffers& op, std::uint32_t half,
                                      float known) {
  Workspace& work = parts.transport.work;
  const std::uint64_t bytes = 2 * op.count * sum_bytes;
  const std::uint64_t missing = samples_.books().address() + (half == 0 ? offsetof(gpu::TransportBook, missing_a)
                                                                        : offsetof(gpu::TransportBook, missing_b));
  const gpu::TransportLoadPush push{.load = samples_.load().address() + half * bytes,
                                    .known = known_[half].address(),
                                    .mass = samples_.mass().address(),
                                    .fluence = samples_.fluence().address(),
                                    .missing = missing,
                                    .unit = samples_.unit().address(),
                                    .scale = work.scale.address(),
                                    .side = op.right_hand_side(work.reduction),
                                    .count = op.count,
                                    .share = 1.0f / static_cast<float>(draws_),
                                    .keep = known};
  work.recorder.dispatch(work.passes.of(shader::transport_load, op.model, op.format), push, op.count, "right-hand side",
                         op.count * (op.block_bytes() + op.field_bytes() + vec3_bytes) + bytes);
}

// A delta = b of one half. The operator lends its rows and vectors; b and x of its own solution stay what they are.
void TransportCorrection::solve(const CorrectionParts& parts, std::uint32_t half, float known) {
  Workspace& work = parts.transport.work;
  OperatorBuffers& op = parts.operators.at(correction_key, 0);
  std::swap(op.b, right_side_[half]);
  std::swap(op.x, change_[half]);
  const SolverKind kind = possible_solver(parts.operators, correction_key, SolverKind::fmg_pcg).solver;
  const bool cycles = rules_of(kind).cycles;
  const LevelTask task{.solver = kind,
                       .boundaries = parts.boundaries.on_device,
                       .tolerance = share_left,
                       .max_iterations = cycles ? most_cycles : most_steps,
                       .smoothing = rules_of(kind).smoothing};
  LevelSolver solver(work, parts.operators, correction_key, 0, task);
  record_load(parts, op, half, known);
  work.recorder.fill(op.x, 0);
  if (cycles) {
    solver.record_start();
    solver.record(most_cycles);
    solver.record_state();
    work.recorder.submit();
    solver.take();
  } else {
    solver.run();
  }
  std::swap(op.b, right_side_[half]);
  std::swap(op.x, change_[half]);
}

// Statistics with all noise, then with that of the solves alone and of all that differs from the present solve.
void TransportCorrection::record_change(const CorrectionParts& parts, bool ahead) {
  Workspace& work = parts.transport.work;
  const LevelBuffers& level = parts.transport.level;
  gpu::TransportChangePush push{.vertices = level.vertices.address(),
                                .faces = level.faces.address(),
                                .face_offset = level.face_offset.address(),
                                .face_incidence = level.face_incidence.address(),
                                .share = parts.operators.at(correction_key, 0).surface_share.address(),
                                .boundaries = parts.boundaries.on_device,
                                .scale = work.scale.address(),
                                .gathered = samples_.gathered().address(),
                                .change_a = change_[0].address(),
                                .change_b = change_[1].address(),
                                .books = samples_.books().address(),
                                .before = halves_.address(),
                                .change = statistics_.address(),
                                .reduction = work.reduction.address(),
                                .count = level.surface_vertex_count,
                                .face_count = level.face_count,
                                .ahead = ahead ? 1u : 0u,
                                .solves = 0};
  for (; push.solves < 2; ++push.solves, push.ahead = 0) {
    work.recorder.dispatch(work.passes.of(shader::transport_change), push, level.surface_vertex_count,
                           "transport change", 3 * level.face_count * (sizeof(glm::uvec3) + 12 * vec3_bytes));
    push.change += sizeof(gpu::TransportChange);
  }
  work.recorder.copy(statistics_, statistics_on_host_, statistics_.size());
}

void TransportCorrection::record_faces(const CorrectionParts& parts) {
  Workspace& work = parts.transport.work;
  const LevelBuffers& level = parts.transport.level;
  const gpu::TransportFacesPush faces{.vertices = level.vertices.address(),
                                      .tets = level.tets.address(),
                                      .faces = level.faces.address(),
                                      .face_tets = level.face_tets.address(),
                                      .optical = level.optical.address(),
                                      .face_kinds = level.face_kind.address(),
                                      .boundaries = parts.boundaries.on_device,
                                      .scale = work.scale.address(),
                                      .gathered = samples_.gathered().address(),
                                      .change_a = change_[0].address(),
                                      .change_b = change_[1].address(),
                                      .books = samples_.books().address(),
                                      .halves = halves_.address(),
                                      .exitance = exitance_.address(),
                                      .count = level.face_count,
                                      .even = level.even ? 1u : 0u};
  const std::uint64_t of_tet = sizeof(std::uint32_t) + sizeof(glm::uvec4) + sizeof(gpu::Optical);
  work.recorder.dispatch(work.passes.of(shader::transport_faces), faces, level.face_count, "transport change",
                         level.face_count * (sizeof(glm::uvec3) + 15 * vec3_bytes + of_tet));
}

// So many draws of points more; then the solves, and what they say.
void TransportCorrection::draw(const CorrectionParts& parts, const Sampling& sampling, std::uint32_t draws,
                               const TransportShares& shares) {
  for (std::uint32_t k = 0; k < draws; ++k) {
    if (parts.check && sampling.most_draws > 1) {
      parts.transport.work.recorder.submit();
      parts.check();
    }
    samples_.record_draw(parts.transport, sampling.directions, sampling.share);
  }
  draws_ += draws;
  samples_.record_books(parts.transport, 1.0f / static_cast<float>(draws_), shares.known);
  for (std::uint32_t half = 0; half < gpu::TRANSPORT_HALVES; ++half) solve(parts, half, shares.known);
  record_change(parts, shares.ahead);
  samples_.record_segments(parts.transport);
  parts.transport.work.recorder.submit();
}

CorrectedSweep TransportCorrection::sweep(const CorrectionParts& parts, const Sampling& sampling,
                                          const TransportShares& shares) {
  samples_.record_source(parts.transport, shares);
  samples_.record_exitance(parts.transport, sampling.face_rays, shares.known);
  samples_.record_no_load(parts.transport);
  std::swap(right_side_, known_);
  draws_ = 0;
  draw(parts, sampling, 1, shares);
  const std::span<const gpu::TransportChange> found = statistics_on_host_.mapped_as<gpu::TransportChange>();
  const double segments = segments_per_tet * parts.transport.level.tet_count;
  for (double most = sampling.most_draws; draws_ < most; most = draws_ * segments / samples_.segments()) {
    const ErrorEstimate noise = relative(found[1].noise, found[1].size);
    const double all = draws_ * excess_of(noise, sampling.noise_before, sampling.noise_wanted);
    if (all <= draws_) break;
    draw(parts, sampling, static_cast<std::uint32_t>(std::ceil(std::min(all, most))) - draws_, shares);
  }
  solves_noise_ = relative(found[1].noise, found[1].size);
  changed_ = relative(found[1].change, found[1].size);
  record_faces(parts);
  samples_.record_step(parts.transport, right_side_, change_, shares, 1.0f / static_cast<float>(draws_));
  samples_.record_state(parts.transport);
  if (!std::isfinite(found[0].change.x) || !std::isfinite(found[0].noise.x) || !std::isfinite(found[0].size.x)) {
    throw SolverError("transport correction: met a value that is not finite");
  }
  const ErrorEstimate all = relative(found[0].noise, found[0].size);
  const double faces = parts.transport.level.face_count;
  const auto of_part = [&](double at_vertices, double of_solves) { return of_patches(at_vertices, of_solves, faces); };
  return {relative(found[0].change, found[0].size), by_parts(of_part, all, solves_noise_),
          sampling.share * draws_ * samples_.points()};
}

void TransportCorrection::start(const CorrectionParts& parts, const WalkTask& task, const TransportShares& shares) {
  Recorder& recorder = parts.transport.work.recorder;
  samples_.record_start(parts.transport, task, parts.solved.op, shares);
  OperatorBuffers& op = parts.operators.at(correction_key, 0);
  record_surface_dimmest(parts.transport.work, parts.results.vertex_exitance(), op.surface_share, op.surface_count);
  const device::Buffer& exitance = parts.results.exitance();
  for (std::uint32_t half = 0; half < gpu::TRANSPORT_HALVES; ++half) {
    recorder.copy(exitance, halves_, exitance.size(), half * exitance.size());
  }
}

// The halves are what sweeps see, their mean over what they should is the exitance.
std::array<std::vector<glm::vec3>, 2> TransportCorrection::exitance_by_halves(device::Device& device) const {
  const auto seen = device::download<glm::vec3>(device, halves_), both = device::download<glm::vec3>(device, exitance_);
  const std::size_t faces = both.size();
  std::array<std::vector<glm::vec3>, 2> found{std::vector<glm::vec3>(faces), std::vector<glm::vec3>(faces)};
  for (std::size_t f = 0; f < faces; ++f) {
    const glm::vec3 a = seen[f], b = seen[faces + f];
    for (int c = 0; c < 3; ++c) {
      const float whole = a[c] + b[c] > 0 ? 2 * both[f][c] / (a[c] + b[c]) : 1;
      found[0][f][c] = whole * a[c];
      found[1][f][c] = whole * b[c];
    }
  }
  return found;
}

// What is known of the frames before is carried on: of tets that are where they were, what rays found for the field
// before, in its coefficients, is taken away by the same rays that see the present one, so that the mean is that of the
// present one alone; of tets that have moved it is averaged, and what lags so is not added up.
TransportShares TransportCorrection::shares_in_motion(std::uint32_t frames) const {
  const float newest = std::max(least_share, 1.0f / static_cast<float>(frames + 1));
  const bool ahead = frames > 0;
  if (moved_) return {.present = newest, .before = 0, .known = 1 - newest, .ahead = ahead, .adds = !ahead};
  return {.present = 1, .before = 1 - newest, .known = 1 - newest, .apart = edited_ && ahead, .ahead = ahead};
}

CorrectedSweep TransportCorrection::sweep_in_motion(const CorrectionParts& parts, const WalkTask& task,
                                                    const TransportShares& shares) {
  start(parts, task, shares);
  if (moved_ && shares.ahead) samples_.record_carried(parts.transport, parts.boundaries);
  if (!shares.ahead) drawn_share_ = 1;
  const Sampling sampling{
      .directions = motion_directions, .face_rays = motion_rays, .most_draws = 1, .share = drawn_share_};
  const CorrectedSweep swept = sweep(parts, sampling, shares);
  const double excess = excess_of(solves_noise_, {}, motion_noise_wanted);
  if (excess > 1) drawn_share_ = std::min(2 * drawn_share_, 1.0);
  if (excess < halving_excess) drawn_share_ = std::max(drawn_share_ / 2, least_drawn);
  return swept;
}

// The second sweep and those behind it sample what the one before has changed, whose noise is small.
void TransportCorrection::sweep_at_rest(const CorrectionParts& parts, const SolveOptions& options,
                                        CorrectionReport& report) {
  samples_.begin_seeds(options.sweep_seed);
  const ErrorEstimate enough = wanted(options);
  const std::uint32_t most = options.sweeps > 0 ? options.sweeps : most_sweeps;
  do {
    const bool first = report.sweeps.empty();
    const ErrorEstimate noise = first ? ErrorEstimate{} : solves_noise_;
    const TransportShares shares = first ? TransportShares{1, 0, 0} : TransportShares{1, 1, 1};
    report.sweeps.push_back(sweep(parts, {rest_directions, rest_rays, most_draws, enough, noise}, shares));
    parts.transport.work.recorder.submit();
    report.returns = samples_.returns();
  } while (report.sweeps.size() < most && (options.sweeps > 0 || !last_of_all(report, enough)));
  report.changed = change_of_all(report);
}

void TransportCorrection::record_taken(const CorrectionParts& parts, const CorrectionReport& report) {
  if (report.taken.whole < 1) samples_.record_taken(parts.transport, parts.solved.op, report.taken.whole);
}

CorrectionReport TransportCorrection::run(const CorrectionParts& parts, const SolveOptions& options,
                                          const WalkTask& task) {
  CorrectionReport report;
  report.slow = parts.slow;
  const std::uint32_t frames = std::exchange(frames_, 0);  // nothing is known where this does not come to its end
  if (options.warm) {
    const TransportShares shares = shares_in_motion(frames);
    report.sweeps.push_back(sweep_in_motion(parts, task, shares));
    report.goes_on = shares.ahead && shares.adds;
    report.changed = changed_;
    report.taken = share_taken(report, 0);
    parts.transport.work.recorder.submit();
    report.returns = samples_.returns();
    frames_ = report.sweeps.back().noise.whole <= most_noise_known ? frames + 1 : 0;
  } else {
    start(parts, {task.method, task.even, task.mean_rays, options.sweep_seed}, {});
    sweep_at_rest(parts, options, report);
    frames_ = frames_of_rest;
    drawn_share_ = 1;
  }
  moved_ = edited_ = false;
  report.segments = samples_.segments();
  return report;
}

TransportPower TransportCorrection::power(const glm::dvec3& scale, const glm::dvec3& scattered_out) const {
  TransportPower power = samples_.power(scale);
  power.entered_again += power.share_again * scattered_out;
  return power;
}

}  // namespace quadgraph
