#include "engine/solve/certificate.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "engine/base/text.h"
#include "engine/device/memory.h"
#include "engine/solve/mesh_error.h"
#include "engine/solve/moved_bytes.h"
#include "engine/solve/patch_sums.h"
#include "engine/solve/source_walk.h"
#include "engine/solve/surface_parts.h"
#include "interface/transport/certify.comp.h"
#include "shaders/shared/random.h"

namespace quadgraph {
namespace {

constexpr std::uint64_t counts_at = gpu::CERTIFY_SUMS * FIXED_WORDS * gpu::WALK_SUMS;  // words

// Of the light that enters a walk counts with one part in so many, whatever it stands for.
constexpr double unit_parts = 1048576;

constexpr double first_walks = 4e3;     // of a round, from which the speed is known
constexpr double fixed_walks = 2e4;     // of a round, where no time is given, or fewer that cross
constexpr double fixed_segments = 1e7;  // so many tets together
constexpr double longest_round = 0.4;   // s
constexpr double most_walks = 1e7;      // of a round
constexpr double chance = 2;            // standard errors within which what was measured tells nothing
constexpr double standard_errors = 3;   // from which on a difference is no chance

// What a sentence says of a part; empty where it has nothing against it.
std::string against(const char* name, const CertifiedPart& part, double stated) {
  const double least = std::max(std::abs(part.power) - standard_errors * part.power_noise,
                                part.error - standard_errors * part.error_noise);
  if (part.power_noise == 0 || least <= confidence * stated) return "";
  return std::string(name) + " by " + percent_text(std::max(std::abs(part.power), part.error)) + " where " +
         percent_text(stated) + " is stated";
}

}  // namespace

Certifier::Certifier(device::Device& device, const Level& level)
    : patch_(surface_patches(level, [&] { device.heed(); })),
      importance_(device, level.vertex_count() * sizeof(glm::vec3), device::Place::device, "certificate/importance"),
      leaving_(device, walk_batches * level.face_count() * sum_bytes, device::Place::device, "certificate/leaving"),
      sums_(device, (counts_at + 2 * gpu::WALK_SUMS) * sizeof(std::uint32_t), device::Place::device,
            "certificate/sums"),
      sums_on_host_(device, sums_.size(), device::Place::host, "certificate/sums, read back") {}

void Certifier::forget(Workspace& work) {
  work.recorder.fill(leaving_, 0);
  work.recorder.submit();
}

// One round of all beams, about so many walks.
void Certifier::round(const CertifiedSolution& solution, const Task& task, double walks, std::uint32_t number,
                      Made& made) {
  Workspace& work = solution.work;
  const LevelBuffers& level = solution.level;
  const std::uint32_t batch = number % walk_batches;
  const glm::dvec3 entered = solution.entered * glm::dvec3(solution.scale.inverse);
  gpu::CertifyPush push{.field = solution.field.address(),
                        .beam = solution.beams.on_device.address(),
                        .beam_q = level.beam_q.address(),
                        .scale = work.scale.address(),
                        .leaving = leaving_.address() + batch * level.face_count * sum_bytes,
                        .sums = sums_.address(),
                        .importance = importance_.address(),
                        .g = solution.g,
                        .walk = glm::vec3(3.0 / walks * entered),
                        .unit = glm::vec3(entered / unit_parts),
                        .rays = 1,
                        .sky = 0,
                        .first = gpu::hash(task.seed + number),
                        .guided = task.guided ? 1u : 0u};
  work.recorder.fill(sums_, 0);
  for (const gpu::Beam& beam : solution.beams.beams) {
    const std::uint32_t kind = beam.way.kind;
    if (kind == gpu::BEAM_MEAN) continue;
    push.sky = beam.floats == gpu::BEAM_FACE || beam.picture != 0 ? 1 : 0;
    // As few as there can be: what draws them takes as long as many a walk, and every round has others.
    push.rays = push.sky == 1 || kind != gpu::BEAM_LAMBERTIAN ? FACE_QUARTERS : rays_of(kind, false);
    work.recorder.dispatch(work.passes.of(shader::certify), push, std::uint64_t{level.face_count} * push.rays,
                           "certificate", walk_bytes(level, push.rays));
    push.beam += sizeof(gpu::Beam);
    push.first = gpu::hash(push.first);
  }
  work.recorder.copy(sums_, sums_on_host_, sums_.size());
  work.recorder.submit();
  const auto words = sums_on_host_.mapped_as<const std::uint32_t>();
  const auto powers = quadgraph::powers(words.first(counts_at), glm::dvec3(solution.scale.scale));
  for (std::size_t k = 0; k < gpu::WALK_SUMS; ++k) {
    made.given_up += powers[gpu::CERTIFY_SUMS * k + 2];
    made.walks += words[counts_at + 2 * k];
    made.segments += words[counts_at + 2 * k + 1];
  }
  made.weight[batch] += walks / 3 / unit_parts;
}

Certifier::Made Certifier::measure(const CertifiedSolution& solution, const Task& task) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  const auto since = [](Clock::time_point before) {
    return std::chrono::duration<double>(Clock::now() - before).count();
  };
  Made made;
  const bool timed = task.seconds > 0;
  double walks = timed ? first_walks : fixed_walks / walk_batches;
  round(solution, task, walks, 0, made);
  double took = since(start);
  if (!timed) walks = std::min(fixed_walks, walks * fixed_segments / std::max(made.segments, 1.0));
  made = {};
  forget(solution.work);
  for (std::uint32_t number = 0; number < walk_batches || since(start) + 0.5 * took < task.seconds; ++number) {
    if (task.check) task.check();
    const double wanted = std::clamp(task.seconds / (2 * walk_batches), 0.02, longest_round);
    if (timed && number % walk_batches == 0) walks = std::clamp(walks * wanted / took, first_walks / 8, most_walks);
    const Clock::time_point before = Clock::now();
    round(solution, {task.guided, task.seconds, task.seed + 1, task.check}, walks, number, made);
    took = since(before);
  }
  made.seconds = since(start);
  return made;
}

Certificate Certifier::run(const CertifiedSolution& solution, double seconds, std::uint32_t seed,
                           const std::function<void()>& check) {
  const bool guided = !solution.importance.empty();
  if (guided) {
    device::write_bytes(solution.work.recorder.device(), importance_, std::as_bytes(solution.importance));
  }
  const Made made = measure(solution, {guided, seconds, seed, check});
  const auto [whole, unlit, dimmest] = parts_of(solution, made);
  area_ = solution.surface.area;
  weight_ = made.weight;
  scale_ = glm::dvec3(solution.scale.scale);
  double weight = 0;
  for (const double of_batch : made.weight) weight += of_batch;
  return {.whole = certified(whole),
          .unlit = certified(unlit),
          .dimmest = certified(dimmest),
          .walks = made.walks,
          .segments = made.segments,
          .given_up = sum_of_channels(made.given_up) / weight / std::max(sum_of_channels(solution.entered), 1e-300),
          .seconds = made.seconds,
          .guided = guided};
}

std::array<PatchSums, 3> Certifier::parts_of(const CertifiedSolution& solution, const Made& made) const {
  const SurfaceField& surface = solution.surface;
  const std::size_t faces = surface.area.size();
  const auto words = device::download<std::uint32_t>(solution.work.recorder.device(), leaving_);
  const auto leaving = powers(words, glm::dvec3(solution.scale.scale));
  const SurfaceParts parts = surface_parts(surface, solution.scale.unlit);
  // What little angles divide is not the same by the reduced coefficient: all that leaves is.
  const float direct = solution.g == glm::vec3(0) ? 0.0f : 1.0f;
  const auto part_of = [&](const auto& taken) {
    PatchSums sums;
    for (std::size_t f = 0; f < faces; ++f) {
      if (!taken(f)) continue;
      PatchSums::Patch& patch = sums.patches[patch_[f]];
      const double area = surface.area[f];
      patch.area += area;
      patch.solved += area * glm::dvec3(surface.exitance[f] + direct * surface.unscattered[f]);
      for (std::size_t b = 0; b < walk_batches; ++b) patch.walked[b] += leaving[b * faces + f] / made.weight[b];
    }
    return sums;
  };
  PatchSums whole = part_of([](std::size_t) { return true; });
  const std::vector<bool> dim = dimmest_patches(whole);
  return {std::move(whole), part_of([&](std::size_t f) { return parts.unlit[f]; }),
          part_of([&](std::size_t f) { return dim[patch_[f]]; })};
}

WalkedExitance Certifier::exitance(device::Device& device) const {
  const auto leaving = powers(device::download<std::uint32_t>(device, leaving_), scale_);
  const std::size_t faces = area_.size();
  WalkedExitance found{std::vector<glm::vec3>(faces), std::vector<glm::vec3>(faces)};
  for (std::size_t f = 0; f < faces; ++f) {
    glm::dvec3 sum_of(0), squares(0);
    for (std::size_t b = 0; b < walk_batches; ++b) {
      const glm::dvec3 value = leaving[b * faces + f] / (weight_[b] * area_[f]);
      sum_of += value;
      squares += value * value;
    }
    constexpr double count = walk_batches;
    found.mean[f] = glm::vec3(sum_of / count);
    const glm::dvec3 left = glm::max(squares - sum_of * sum_of / count, glm::dvec3(0));
    found.standard_error[f] = glm::vec3(glm::sqrt(left / (count * (count - 1))));
  }
  return found;
}

void state_disagreement(SolveReport& report) {
  if (!report.certificate || !report.error) return;
  Certificate& found = *report.certificate;
  std::string text;
  for (const std::string& part : {against("the whole surface is off", found.whole, report.error->whole),
                                  against("the unlit part", found.unlit, report.error->unlit),
                                  against("the dimmest third", found.dimmest, report.error->dimmest)}) {
    if (!part.empty()) text += (text.empty() ? "" : ", ") + part;
  }
  found.disagreement = text.empty() ? "" : "random walks contradict the stated error: " + text;
}

void add_phase_error(SolveReport& report) {
  if (!report.certificate || !report.error) return;
  const Certificate& found = *report.certificate;
  const auto beyond = [](const CertifiedPart& part, double stated) {
    const bool told = part.error - chance * part.error_noise > stated;
    return told ? std::sqrt(part.error * part.error - stated * stated) : 0;
  };
  report.phase_error = ErrorEstimate{.whole = beyond(found.whole, report.error->whole),
                                     .unlit = beyond(found.unlit, report.error->unlit),
                                     .dimmest = beyond(found.dimmest, report.error->dimmest)};
  report.error =
      by_parts([](double all, double part) { return std::hypot(all, part); }, *report.error, *report.phase_error);
}

}  // namespace quadgraph
