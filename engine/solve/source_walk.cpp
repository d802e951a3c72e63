#include "engine/solve/source_walk.h"

#include <cmath>

#include "engine/base/error.h"
#include "interface/source/right_hand_side_buried.comp.h"
#include "interface/source/walk_source.comp.h"

namespace quadgraph {
namespace {

constexpr std::uint64_t vec3_bytes = sizeof(glm::vec3);
constexpr std::uint64_t power_bytes = FIXED_WORDS * sizeof(std::uint32_t);

std::uint32_t carriers(const LevelBuffers& level, Method method) {
  return on_vertices(method) ? level.vertex_count : level.tet_count;
}

constexpr std::uint64_t sums_bytes = 2 * gpu::WALK_SUMS * power_bytes;

int place_of(std::uint32_t vertex, const glm::uvec4& tet) {
  int k = 0;
  while (k < 3 && tet[k] != vertex) ++k;
  return k;
}

// From `tet` out of the face opposite corner k into the tet `across`.
std::uint32_t crossing(const Level& level, const glm::uvec4& tet, int k, std::uint32_t across) {
  std::uint32_t packed = across << CROSSING_BITS;
  if (across >= level.tet_count()) return packed;
  const glm::uvec4& next = level.tets[across];
  const std::uint32_t fresh = next[0] + next[1] + next[2] + next[3] - tet[0] - tet[1] - tet[2] - tet[3] + tet[k];
  for (int j = 0; j < 3; ++j) {
    packed |= static_cast<std::uint32_t>(place_of(j == k ? fresh : tet[j], next)) << 2 * j;
  }
  return packed;
}

std::vector<std::uint32_t> crossings_of(const Level& level) {
  std::vector<std::uint32_t> result;
  result.reserve(4 * level.tets.size());
  for (std::size_t t = 0; t < level.tets.size(); ++t) {
    for (int k = 0; k < 4; ++k) result.push_back(crossing(level, level.tets[t], k, level.links[t][k]));
  }
  return result;
}

// Elements that crossings can name.
constexpr std::uint32_t most_nodes = 1u << (32 - CROSSING_BITS);

}  // namespace

std::uint32_t rays_of(std::uint32_t beam_kind, bool mean_rays) {
  return beam_kind == gpu::BEAM_LAMBERTIAN && !mean_rays ? gpu::LAMBERTIAN_RAYS : 1;
}

std::uint64_t walk_bytes(const LevelBuffers& level, std::uint32_t ray_count) {
  constexpr std::uint64_t tet_bytes = 2 * sizeof(std::uint32_t) + vec3_bytes + sizeof(gpu::Optical) + 2 * power_bytes;
  return std::uint64_t{level.face_count} * ray_count * (FACE_QUARTERS * sizeof(float) + 10 * tet_bytes / 2);
}

SourceWalk::SourceWalk(device::Device& device, const Level& level, std::uint32_t number)
    : prefix_("level " + std::to_string(number) + " "),
      unscattered_(device, level.face_count() * power_bytes, device::Place::device, "walk/" + prefix_ + "unscattered") {
  if (level.node_count() > most_nodes) {
    throw InputError(prefix_ + "has " + std::to_string(level.node_count()) +
                     " tets and outside faces; the buried source takes up to " + std::to_string(most_nodes));
  }
  crossings_ = device::upload<std::uint32_t>(device, crossings_of(level), "geometry/" + prefix_ + "crossings");
}

gpu::BodyRef SourceWalk::body(const LevelBuffers& level, double eta, bool even) const {
  return {.vertices = level.vertices.address(),
          .tets = level.tets.address(),
          .crossings = crossings_.address(),
          .faces = level.faces.address(),
          .face_tets = level.face_tets.address(),
          .face_kinds = level.face_kind.address(),
          .optical = level.optical.address(),
          .tet_count = level.tet_count,
          .face_count = level.face_count,
          .flags = (even ? gpu::BODY_EVEN : 0u) | (level.inverted ? gpu::BODY_INVERTED : 0u),
          .eta = static_cast<float>(eta)};
}

void SourceWalk::Sums::make_room(device::Device& device, std::uint64_t bytes, const std::string& prefix) {
  if (sums.size() >= bytes) return;
  sums = {device, bytes, device::Place::device, "walk/" + prefix + "sums"};
  sums_on_host = {device, bytes, device::Place::host, "walk/" + prefix + "sums, read back"};
  scale_on_host = {device, sizeof(gpu::Scale), device::Place::host, "walk/" + prefix + "scale, read back"};
}

void SourceWalk::Sums::read_back(Workspace& work) const {
  work.recorder.copy(sums, sums_on_host, sums.size());
  work.recorder.copy(work.scale, scale_on_host, sizeof(gpu::Scale));
}

WalkPower SourceWalk::Sums::power() const {
  if (sums.size() == 0) return {};  // no beams, no light
  const glm::dvec3 scale(scale_on_host.mapped_as<gpu::Scale>()[0].scale);
  const std::vector<glm::dvec3> shares = powers(sums_on_host.mapped_as<std::uint32_t>(), scale);
  WalkPower power;
  for (std::size_t i = 0; i < shares.size(); i += 2) {
    power.absorbed += shares[i];
    power.unscattered += shares[i + 1];
  }
  return power;
}

void SourceWalk::make_room(device::Device& device, const LevelBuffers& level, const BeamBuffers& beams, Method method,
                           bool again) {
  const auto room = [&](device::Buffer& buffer, std::uint64_t bytes, const char* name) {
    if (buffer.size() != bytes) buffer = {device, bytes, device::Place::device, "walk/" + prefix_ + name};
  };
  room(deposits_[carrier(method)], carriers(level, method) * power_bytes, "deposit");
  std::uint64_t all_sums = 0;
  for (const gpu::Beam& beam : beams.beams) {
    if (beam.way.kind != gpu::BEAM_MEAN) all_sums += sums_bytes;
  }
  sums_.make_room(device, all_sums, prefix_);
  if (!again) return;
  room(all_deposits_[carrier(method)], carriers(level, method) * power_bytes, "deposit with light that entered again");
  room(all_unscattered_, level.face_count * power_bytes, "unscattered with light that entered again");
  sums_again_.make_room(device, sums_bytes, prefix_);
}

gpu::WalkSourcePush SourceWalk::push(const Workspace& work, const LevelBuffers& level, const BeamBuffers& beams,
                                     const WalkTask& task) const {
  return {.body = body(level, task.eta, task.even),
          .beam = beams.on_device.address(),
          .beam_q = level.beam_q.address(),
          .scale = work.scale.address(),
          .deposit = deposit(task.method).address(),
          .unscattered = unscattered().address(),
          .sums = sums_.sums.address(),
          .rays = 1,
          .deposits = (on_vertices(task.method) ? gpu::WALK_VERTICES : gpu::WALK_TETS) |
                      (task.mean_rays ? gpu::WALK_TO_MEAN : 0u)};
}

void SourceWalk::record(Workspace& work, const LevelBuffers& level, const BeamBuffers& beams, const WalkTask& task) {
  if (mean_rays_ != task.mean_rays) invalidate();
  mean_rays_ = task.mean_rays;
  if (walked_[carrier(task.method)]) return;
  walked_[carrier(task.method)] = true;
  make_room(work.recorder.device(), level, beams, task.method, false);
  work.recorder.fill(deposits_[carrier(task.method)], 0);
  work.recorder.fill(unscattered_, 0);
  if (sums_.sums.size() == 0) return;
  work.recorder.fill(sums_.sums, 0);
  gpu::WalkSourcePush push = this->push(work, level, beams, task);
  for (const gpu::Beam& beam : beams.beams) {
    const std::uint32_t kind = beam.way.kind;
    if (kind == gpu::BEAM_MEAN) continue;
    push.rays = rays_of(kind, task.mean_rays);
    work.recorder.dispatch(work.passes.of(shader::walk_source), push, std::uint64_t{level.face_count} * push.rays,
                           "source walk", walk_bytes(level, push.rays));
    push.beam += sizeof(gpu::Beam);
    push.sums += sums_bytes;
  }
  sums_.read_back(work);
}

void SourceWalk::record_again(Workspace& work, const LevelBuffers& level, const BeamBuffers& beams,
                              const WalkTask& task) {
  make_room(work.recorder.device(), level, beams, task.method, true);
  const device::Buffer& deposit = deposits_[carrier(task.method)];
  work.recorder.copy(deposit, all_deposits_[carrier(task.method)], deposit.size());
  work.recorder.copy(unscattered_, all_unscattered_, unscattered_.size());
  work.recorder.fill(sums_again_.sums, 0);
  again_ = true;
  gpu::WalkSourcePush push = this->push(work, level, beams, task);
  push.beam += (beams.beams.size() - 1) * sizeof(gpu::Beam);
  push.sums = sums_again_.sums.address();
  if (task.mean_rays) push.deposits ^= gpu::WALK_TO_MEAN | gpu::WALK_TO_AGAIN;
  work.recorder.dispatch(work.passes.of(shader::walk_source), push, level.face_count, "source walk",
                         walk_bytes(level, 1));
  sums_again_.read_back(work);
}

void SourceWalk::record_right_hand_side(Workspace& work, const LevelBuffers& level, Method method,
                                        OperatorBuffers& op) const {
  const gpu::RightHandSideBuriedPush push{.deposit = deposit(method).address(),
                                          .vertices = level.vertices.address(),
                                          .tets = level.tets.address(),
                                          .side = op.right_hand_side(work.reduction),
                                          .count = op.count,
                                          .deposit_count = carriers(level, method),
                                          .per_volume = method == Method::quadgraph_fdm ? 1u : 0u};
  work.recorder.dispatch(work.passes.of(shader::right_hand_side_buried, op.model, op.format), push, op.count,
                         "right-hand side",
                         op.count * (op.block_bytes() + op.field_bytes()) + carriers(level, method) * power_bytes);
}

std::vector<glm::dvec3> SourceWalk::unscattered_power(device::Device& device, const glm::dvec3& scale) const {
  return powers(device::download<std::uint32_t>(device, unscattered()), scale);
}

WalkPower SourceWalk::power() const {
  WalkPower power = sums_.power();
  if (!again_) return power;
  const WalkPower more = sums_again_.power();
  return {power.absorbed + more.absorbed, power.unscattered + more.unscattered};
}

std::vector<glm::dvec3> powers(std::span<const std::uint32_t> words, const glm::dvec3& scale) {
  std::vector<glm::dvec3> result(words.size() / FIXED_WORDS, glm::dvec3(0));
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::size_t word = i % FIXED_WORDS;
    const auto c = static_cast<int>(word % 3);
    result[i / FIXED_WORDS][c] += std::ldexp(words[i], word < 3 ? 0 : 32) * double{gpu::POWER_UNIT} * scale[c];
  }
  return result;
}

}  // namespace quadgraph
