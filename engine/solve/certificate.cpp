#include "engine/solve/certificate.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "engine/base/text.h"
#include "engine/device/memory.h"
#include "engine/solve/mesh_error.h"
#include "engine/solve/source_walk.h"
#include "engine/solve/surface_parts.h"
#include "interface/transport/certify.comp.h"
#include "shaders/shared/random.h"

namespace quadgraph {
namespace {

constexpr std::uint64_t sum_bytes = FIXED_WORDS * sizeof(std::uint32_t);
constexpr std::uint64_t counts_at = gpu::CERTIFY_SUMS * FIXED_WORDS * gpu::WALK_SUMS;  // words

// Of the light that enters a walk counts with one part in so many, whatever it stands for.
constexpr double unit_parts = 1048576;

constexpr double first_walks = 3e4;     // of a round, from which the speed is known
constexpr double fixed_walks = 2e4;     // of a round, where no time is given, or fewer that cross
constexpr double fixed_segments = 1e7;  // so many tets together
constexpr double longest_round = 0.4;   // s
constexpr double most_walks = 1e7;      // of a round
constexpr double most_noise = 0.3;      // of the power of a part of which anything is said
constexpr double chance = 2;            // standard errors within which what was measured tells nothing
constexpr double standard_errors = 3;   // from which on a difference is no chance

double sum(const glm::dvec3& v) {
  return v.x + v.y + v.z;
}

// What the batches say of a part of the surface: power of the solution and of the walks, and by patch.
struct PartSums {
  struct Patch {
    double area = 0;
    glm::dvec3 solved{0};
    std::array<glm::dvec3, Certifier::batches> walked{};
  };
  std::vector<Patch> patches = std::vector<Patch>(most_patches);
};

// Mean and its standard error.
template <typename Values>
std::pair<double, double> mean_of(const Values& values) {
  const double count = static_cast<double>(values.size());
  double mean = 0, squares = 0;
  for (const double value : values) mean += value / count;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return {mean, std::sqrt(squares / (count * (count - 1)))};
}

// Of the batches but one, or of all: the products of what different ones differ from the solution by, which the noise
// of neither is in, over patches; relative to the light of the walks.
double relative_square(const PartSums& part, std::size_t without) {
  double products = 0, size = 0;
  for (const PartSums::Patch& patch : part.patches) {
    if (patch.area == 0) continue;
    glm::dvec3 difference{0}, walked{0};
    double own = 0, count = 0;
    for (std::size_t b = 0; b < patch.walked.size(); ++b) {
      if (b == without) continue;
      const glm::dvec3 d = patch.solved - patch.walked[b];
      difference += d;
      walked += patch.walked[b];
      own += glm::dot(d, d);
      ++count;
    }
    products += (glm::dot(difference, difference) - own) / (count * (count - 1)) / patch.area;
    size += glm::dot(walked, walked) / (count * count) / patch.area;
  }
  return size > 0 ? products / size : 0;
}

// The third of the surface whose patches send out least. By face it would be where the noise of the solution is low.
std::vector<bool> dimmest_patches(const PartSums& whole) {
  std::vector<std::size_t> order;
  double left = 0;
  for (std::size_t k = 0; k < whole.patches.size(); ++k) {
    if (whole.patches[k].area == 0) continue;
    order.push_back(k);
    left += whole.patches[k].area / 3;
  }
  const auto bright = [&](std::size_t k) { return sum(whole.patches[k].solved) / whole.patches[k].area; };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return bright(a) < bright(b); });
  std::vector<bool> taken(whole.patches.size());
  for (const std::size_t k : order) {
    left -= whole.patches[k].area;
    taken[k] = true;
    if (left <= 0) break;
  }
  return taken;
}

CertifiedPart certified(const PartSums& part) {
  std::array<double, Certifier::batches> walked{};
  double solved = 0;
  for (const PartSums::Patch& patch : part.patches) {
    solved += sum(patch.solved);
    for (std::size_t b = 0; b < walked.size(); ++b) walked[b] += sum(patch.walked[b]);
  }
  const auto [power, noise] = mean_of(walked);
  if (!(power > 0) || noise > most_noise * power) return {};
  const double square = relative_square(part, walked.size());
  // Jackknife over the batches.
  const double count = static_cast<double>(walked.size());
  std::array<double, Certifier::batches> left_out{};
  for (std::size_t b = 0; b < left_out.size(); ++b) left_out[b] = relative_square(part, b);
  const double spread = (count - 1) * mean_of(left_out).second;
  const double error = std::sqrt(std::max(square, 0.0));
  return {.power = solved / power - 1,
          .power_noise = noise / power * (solved / power),
          .error = error,
          .error_noise = std::sqrt(std::max(square, 0.0) + spread) - error};
}

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
    : patch_(surface_patches(level)),
      leaving_(device, batches * level.face_count() * sum_bytes, device::Place::device, "certificate/leaving"),
      sums_(device, (counts_at + 2 * gpu::WALK_SUMS) * sizeof(std::uint32_t), device::Place::device,
            "certificate/sums"),
      sums_on_host_(device, sums_.size(), device::Place::host, "certificate/sums, read back") {}

void Certifier::forget(Workspace& work) {
  work.recorder.fill(leaving_, 0);
  work.recorder.submit();
}

// One round of all beams, about so many walks.
void Certifier::round(const CertifiedSolution& solution, double walks, std::uint32_t batch, std::uint32_t seed,
                      Made& made) {
  Workspace& work = solution.work;
  const LevelBuffers& level = solution.level;
  const glm::dvec3 entered = solution.entered * glm::dvec3(solution.scale.inverse);
  gpu::CertifyPush push{.field = solution.field.address(),
                        .beam = solution.beams.on_device.address(),
                        .beam_q = level.beam_q.address(),
                        .scale = work.scale.address(),
                        .leaving = leaving_.address() + batch * level.face_count * sum_bytes,
                        .sums = sums_.address(),
                        .g = solution.g,
                        .walk = glm::vec3(3.0 / walks * entered),
                        .unit = glm::vec3(entered / unit_parts),
                        .rays = 1,
                        .sky = 0,
                        .first = gpu::hash(seed)};
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

Certificate Certifier::run(const CertifiedSolution& solution, double seconds, std::uint32_t seed,
                           const std::function<void()>& check) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  const auto since = [](Clock::time_point before) {
    return std::chrono::duration<double>(Clock::now() - before).count();
  };
  Made made;
  const bool timed = seconds > 0;
  double walks = timed ? first_walks : fixed_walks / batches;
  round(solution, walks, 0, seed, made);
  double took = since(start);
  if (!timed) walks = std::min(fixed_walks, walks * fixed_segments / std::max(made.segments, 1.0));
  made = {};
  forget(solution.work);
  for (std::uint32_t number = 0; number < batches || since(start) + 0.5 * took < seconds; ++number) {
    if (check) check();
    const double wanted = std::clamp(seconds / (2 * batches), 0.02, longest_round);
    if (timed && number % batches == 0) walks = std::clamp(walks * wanted / took, first_walks / 8, most_walks);
    const Clock::time_point before = Clock::now();
    round(solution, walks, number % batches, seed + number + 1, made);
    took = since(before);
  }
  Certificate found = judge(solution, made);
  found.seconds = since(start);
  return found;
}

Certificate Certifier::judge(const CertifiedSolution& solution, const Made& made) {
  const SurfaceField& surface = solution.surface;
  const std::size_t faces = surface.area.size();
  const auto words = device::download<std::uint32_t>(solution.work.recorder.device(), leaving_);
  const auto leaving = powers(words, glm::dvec3(solution.scale.scale));
  const SurfaceParts parts = surface_parts(surface, solution.scale.unlit);
  // What little angles divide is not the same by the reduced coefficient: all that leaves is.
  const float direct = solution.g == glm::vec3(0) ? 0.0f : 1.0f;
  const auto part_of = [&](const auto& taken) {
    PartSums sums;
    for (std::size_t f = 0; f < faces; ++f) {
      if (!taken(f)) continue;
      PartSums::Patch& patch = sums.patches[patch_[f]];
      const double area = surface.area[f];
      patch.area += area;
      patch.solved += area * glm::dvec3(surface.exitance[f] + direct * surface.unscattered[f]);
      for (std::size_t b = 0; b < batches; ++b) patch.walked[b] += leaving[b * faces + f] / made.weight[b];
    }
    return sums;
  };
  const PartSums whole = part_of([](std::size_t) { return true; });
  const std::vector<bool> dim = dimmest_patches(whole);
  double weight = 0;
  for (const double of_batch : made.weight) weight += of_batch;
  return {.whole = certified(whole),
          .unlit = certified(part_of([&](std::size_t f) { return parts.unlit[f]; })),
          .dimmest = certified(part_of([&](std::size_t f) { return dim[patch_[f]]; })),
          .walks = made.walks,
          .segments = made.segments,
          .given_up = sum(made.given_up) / weight / std::max(sum(solution.entered), 1e-300)};
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
