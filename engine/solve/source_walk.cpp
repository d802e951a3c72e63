#include "engine/solve/source_walk.h"

#include <cmath>

namespace quadgraph {
namespace {

constexpr std::uint64_t vec3_bytes = sizeof(glm::vec3);
constexpr std::uint64_t power_bytes = FIXED_WORDS * sizeof(std::uint32_t);

std::uint32_t carriers(const LevelBuffers& level, Method method) {
  return method == Method::fem ? level.vertex_count : level.tet_count;
}

std::uint32_t rays(std::uint32_t beam_kind) {
  return beam_kind == gpu::BEAM_LAMBERTIAN ? gpu::LAMBERTIAN_RAYS : 1;
}

// Two sums of every workgroup.
std::uint64_t sums_bytes(const LevelBuffers& level, std::uint32_t beam_kind) {
  const std::uint64_t groups =
      (std::uint64_t{level.face_count} * rays(beam_kind) + WORKGROUP_SIZE - 1) / WORKGROUP_SIZE;
  return 2 * groups * power_bytes;
}

// Of one beam: every invocation looks at its face; half the faces are lit, evenly, and a ray crosses ten tets, about as
// many as in marble at the finest level.
std::uint64_t walk_bytes(const LevelBuffers& level, std::uint32_t ray_count) {
  constexpr std::uint64_t tet_bytes =
      sizeof(glm::uvec4) + sizeof(std::uint32_t) + vec3_bytes + sizeof(gpu::Optical) + 2 * power_bytes;
  return std::uint64_t{level.face_count} * ray_count * (FACE_QUARTERS * vec3_bytes + 10 * tet_bytes / 2);
}

}  // namespace

SourceWalk::SourceWalk(vk::Context& context, const LevelBuffers& level, std::uint32_t number)
    : prefix_("level " + std::to_string(number) + " "),
      unscattered_(context, level.face_count * power_bytes, vk::Place::device, prefix_ + "unscattered") {}

void SourceWalk::record(Workspace& work, const LevelBuffers& level, const BeamBuffers& beams, Method method,
                        double eta) {
  if (walked_[carrier(method)]) return;
  vk::Context& context = work.recorder.context();
  vk::Buffer& deposit = deposits_[carrier(method)];
  const std::uint64_t deposit_bytes = carriers(level, method) * power_bytes;
  if (deposit.size() != deposit_bytes) deposit = {context, deposit_bytes, vk::Place::device, prefix_ + "deposit"};
  std::uint64_t all_sums = 0;
  for (const std::uint32_t kind : beams.kinds) all_sums += sums_bytes(level, kind);
  if (sums_.size() != all_sums) {
    sums_ = {context, all_sums, vk::Place::device, prefix_ + "walk sums"};
    sums_on_host_ = {context, all_sums, vk::Place::host, prefix_ + "walk sums, read back"};
    scale_on_host_ = {context, sizeof(gpu::Scale), vk::Place::host, prefix_ + "scale, read back"};
  }
  work.recorder.fill(deposit, 0);
  work.recorder.fill(unscattered_, 0);
  work.recorder.fill(sums_, 0);
  std::uint64_t sums_offset = 0;
  for (std::size_t beam = 0; beam < beams.kinds.size(); ++beam) {
    const gpu::WalkSourcePush push{
        .vertices = level.vertices.address(),
        .tets = level.tets.address(),
        .links = level.links.address(),
        .faces = level.faces.address(),
        .face_tets = level.face_tets.address(),
        .face_kinds = level.face_kind.address(),
        .optical = level.optical.address(),
        .beam = beams.records.address() + beam * sizeof(gpu::BeamRecord),
        .quarter_q = level.beam_q.address() + beam * level.face_count * FACE_QUARTERS * vec3_bytes,
        .scale = work.scale.address(),
        .deposit = deposit.address(),
        .unscattered = unscattered_.address(),
        .sums = sums_.address() + sums_offset,
        .face_count = level.face_count,
        .rays = rays(beams.kinds[beam]),
        .tet_count = level.tet_count,
        .fem = method == Method::fem ? 1u : 0u,
        .eta = static_cast<float>(eta)};
    work.recorder.dispatch(work.passes.walk_source, push, std::uint64_t{level.face_count} * push.rays, "source walk",
                           walk_bytes(level, push.rays));
    sums_offset += sums_bytes(level, beams.kinds[beam]);
  }
  work.recorder.copy(sums_, sums_on_host_, all_sums);
  work.recorder.copy(work.scale, scale_on_host_, sizeof(gpu::Scale));
  walked_[carrier(method)] = true;
}

void SourceWalk::record_right_hand_side(Workspace& work, const LevelBuffers& level, Method method,
                                        OperatorBuffers& op) const {
  const gpu::RightHandSideBuriedPush push{.deposit = deposit(method).address(),
                                          .vertices = level.vertices.address(),
                                          .tets = level.tets.address(),
                                          .diagonal = op.diagonal.address(),
                                          .b = op.b.address(),
                                          .state = op.state.address(),
                                          .reduction = work.reduction.address(),
                                          .count = op.count,
                                          .deposit_count = carriers(level, method),
                                          .per_volume = method == Method::quadgraph_fdm ? 1u : 0u};
  work.recorder.dispatch(work.passes.right_hand_side_buried, push, op.count, "right-hand side",
                         op.count * 2 * vec3_bytes + carriers(level, method) * power_bytes);
}

WalkPower SourceWalk::power() const {
  const glm::dvec3 scale(scale_on_host_.mapped_as<gpu::Scale>()[0].scale);
  const std::vector<glm::dvec3> sums = powers(sums_on_host_.mapped_as<std::uint32_t>(), scale);
  WalkPower power;
  for (std::size_t i = 0; i < sums.size(); i += 2) {
    power.absorbed += sums[i];
    power.unscattered += sums[i + 1];
  }
  return power;
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
