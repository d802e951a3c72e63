#include "engine/solve/source_walk.h"

#include <cmath>
#include <cstring>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/listener.h"
#include "engine/solve/moved_bytes.h"
#include "interface/source/right_hand_side_buried.comp.h"
#include "interface/source/tet_cells.comp.h"
#include "interface/source/walk_source.comp.h"

namespace quadgraph {
namespace {

constexpr std::uint64_t power_bytes = FIXED_WORDS * sizeof(std::uint32_t);

std::uint32_t carriers(const LevelBuffers& level, Method method) {
  return on_vertices(method) ? level.vertex_count : level.tet_count;
}

constexpr std::size_t sums_words = std::size_t{2} * gpu::WALK_SUMS * FIXED_WORDS;
constexpr std::uint64_t sums_bytes = (sums_words + gpu::WALK_SUMS) * sizeof(std::uint32_t);

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

// But for the shape.
std::vector<gpu::TetCell> cells_of(const Level& level, const Listener& listener) {
  std::vector<gpu::TetCell> result(level.tets.size());
  for (std::size_t t = 0; t < level.tets.size(); ++t) {
    heed(listener, t);
    for (int k = 0; k < 4; ++k) result[t].crossings[k] = crossing(level, level.tets[t], k, level.links[t][k]);
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
  constexpr std::uint64_t tet_bytes =
      sizeof(gpu::TetCell) + sizeof(std::uint32_t) + sizeof(gpu::Optical) + 2 * power_bytes;
  return std::uint64_t{level.face_count} * ray_count * (FACE_QUARTERS * sizeof(float) + 10 * tet_bytes / 2);
}

SourceWalk::SourceWalk(device::Device& device, const Level& level, std::uint32_t number)
    : prefix_("level " + std::to_string(number) + " "),
      unscattered_(device, level.face_count() * power_bytes, device::Place::device, "walk/" + prefix_ + "unscattered") {
  if (level.node_count() > most_nodes) {
    throw InputError(prefix_ + "has " + std::to_string(level.node_count()) +
                     " tets and outside faces; the buried source takes up to " + std::to_string(most_nodes));
  }
  cells_ =
      device::upload<gpu::TetCell>(device, cells_of(level, [&] { device.heed(); }), "geometry/" + prefix_ + "cells");
  body_on_device_ = {device, sizeof(gpu::BodyRef), device::Place::device, "walk/" + prefix_ + "body"};
}

void SourceWalk::record_cells(Workspace& work, const LevelBuffers& level) {
  if (!std::exchange(moved_, false)) return;
  const gpu::TetCellsPush push{.vertices = level.vertices.address(),
                               .tets = level.tets.address(),
                               .cells = cells_.address(),
                               .count = level.tet_count,
                               .inverted = level.inverted ? 1u : 0u};
  work.recorder.dispatch(work.passes.of(shader::tet_cells), push, level.tet_count, "tets for rays",
                         level.tet_count * (sizeof(glm::uvec4) + 4 * vec3_bytes + 3 * sizeof(glm::vec4)));
}

gpu::BodyRef SourceWalk::body(const LevelBuffers& level, bool even) const {
  return {.vertices = level.vertices.address(),
          .tets = level.tets.address(),
          .cells = cells_.address(),
          .faces = level.faces.address(),
          .face_tets = level.face_tets.address(),
          .face_kinds = level.face_kind.address(),
          .optical = level.optical.address(),
          .etendue = level.etendue.address(),
          .shared_normals = 0,
          .tet_count = level.tet_count,
          .face_count = level.face_count,
          .flags = even ? gpu::BODY_EVEN : 0u};
}

void SourceWalk::Sums::make_room(device::Device& device, const std::string& prefix) {
  if (sums.size() > 0) return;
  sums = {device, sums_bytes, device::Place::device, "walk/" + prefix + "sums"};
  sums_on_host = {device, sums_bytes, device::Place::host, "walk/" + prefix + "sums, read back"};
  scale_on_host = {device, sizeof(gpu::Scale), device::Place::host, "walk/" + prefix + "scale, read back"};
}

void SourceWalk::Sums::read_back(Workspace& work) const {
  work.recorder.copy(sums, sums_on_host, sums.size());
  work.recorder.copy(work.scale, scale_on_host, sizeof(gpu::Scale));
}

WalkPower SourceWalk::Sums::power() const {
  if (sums.size() == 0) return {};  // nothing was walked
  const glm::dvec3 scale(scale_on_host.mapped_as<gpu::Scale>()[0].scale);
  const std::span<const std::uint32_t> words = sums_on_host.mapped_as<std::uint32_t>();
  const std::vector<glm::dvec3> shares = powers(words.first(sums_words), scale);
  WalkPower power;
  for (std::size_t i = 0; i < shares.size(); i += 2) {
    power.absorbed += shares[i];
    power.unscattered += shares[i + 1];
  }
  return power;
}

double SourceWalk::Sums::segments() const {
  if (sums.size() == 0) return 0;
  double sum = 0;
  for (const std::uint32_t crossed : sums_on_host.mapped_as<std::uint32_t>().subspan(sums_words)) sum += crossed;
  return sum;
}

void SourceWalk::make_room(device::Device& device, const LevelBuffers& level, Method method, bool again) {
  const auto room = [&](device::Buffer& buffer, std::uint64_t bytes, const char* name) {
    if (buffer.size() != bytes) buffer = {device, bytes, device::Place::device, "walk/" + prefix_ + name};
  };
  room(deposits_[carrier(method)], carriers(level, method) * power_bytes, "deposit");
  sums_.make_room(device, prefix_);
  if (!again) return;
  room(all_deposits_[carrier(method)], carriers(level, method) * power_bytes, "deposit with light that entered again");
  room(all_unscattered_, level.face_count * power_bytes, "unscattered with light that entered again");
  sums_again_.make_room(device, prefix_);
}

gpu::WalkSourcePush SourceWalk::push(Workspace& work, const LevelBuffers& level, const BeamBuffers& beams,
                                     const WalkTask& task) {
  const gpu::BodyRef walked = body(level, task.even);
  if (std::memcmp(&walked, &body_, sizeof(walked)) != 0) {
    device::write_bytes(work.recorder.device(), body_on_device_, std::as_bytes(std::span(&walked, 1)));
    body_ = walked;
  }
  return {.body = body_on_device_.address(),
          .beams = beams.on_device.address(),
          .beam_q = level.beam_q.address(),
          .scale = work.scale.address(),
          .deposit = deposit(task.method).address(),
          .unscattered = unscattered().address(),
          .sums = sums_.sums.address(),
          .beam_count = 1,
          .deposits = (on_vertices(task.method) ? gpu::WALK_VERTICES : gpu::WALK_TETS) |
                      (task.mean_rays ? gpu::WALK_TO_MEAN | gpu::WALK_ONE_RAY : 0u)};
}

void SourceWalk::record(Workspace& work, const LevelBuffers& level, const BeamBuffers& beams, const WalkTask& task) {
  if (mean_rays_ != task.mean_rays) invalidate();
  mean_rays_ = task.mean_rays;
  if (walked_[carrier(task.method)]) return;
  walked_[carrier(task.method)] = true;
  record_cells(work, level);
  make_room(work.recorder.device(), level, task.method, false);
  work.recorder.fill(deposits_[carrier(task.method)], 0);
  work.recorder.fill(unscattered_, 0);
  work.recorder.fill(sums_.sums, 0);
  gpu::WalkSourcePush push = this->push(work, level, beams, task);
  push.beam_count = 0;
  std::uint32_t rays = 0;
  for (const gpu::Beam& beam : beams.beams) {
    if (beam.way.kind == gpu::BEAM_MEAN) continue;  // the last
    ++push.beam_count;
    rays += rays_of(beam.way.kind, task.mean_rays);
  }
  if (rays > 0) {
    work.recorder.dispatch(work.passes.of(shader::walk_source), push, std::uint64_t{level.face_count} * rays,
                           "source walk", walk_bytes(level, rays));
  }
  sums_.read_back(work);
}

void SourceWalk::record_again(Workspace& work, const LevelBuffers& level, const BeamBuffers& beams,
                              const WalkTask& task) {
  make_room(work.recorder.device(), level, task.method, true);
  const device::Buffer& deposit = deposits_[carrier(task.method)];
  work.recorder.copy(deposit, all_deposits_[carrier(task.method)], deposit.size());
  work.recorder.copy(unscattered_, all_unscattered_, unscattered_.size());
  work.recorder.fill(sums_again_.sums, 0);
  again_ = true;
  gpu::WalkSourcePush push = this->push(work, level, beams, task);
  push.beams += (beams.beams.size() - 1) * sizeof(gpu::Beam);
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

double SourceWalk::segments() const {
  return sums_.segments() + (again_ ? sums_again_.segments() : 0);
}

std::vector<glm::dvec3> powers(std::span<const std::uint32_t> words, const glm::dvec3& scale) {
  std::vector<glm::dvec3> result(words.size() / FIXED_WORDS, glm::dvec3(0));
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::size_t word = i % FIXED_WORDS;
    const auto c = static_cast<int>(word / 2);
    result[i / FIXED_WORDS][c] += std::ldexp(words[i], word % 2 == 0 ? 0 : 32) * double{gpu::POWER_UNIT} * scale[c];
  }
  return result;
}

}  // namespace quadgraph
