#include "engine/solve/source_walk.h"

namespace quadgraph {
namespace {

constexpr std::uint64_t vec3_bytes = sizeof(glm::vec3);
constexpr std::uint64_t power_bytes = FIXED_WORDS * sizeof(std::uint32_t);

std::uint32_t carriers(const LevelBuffers& level, Method method) {
  return method == Method::fem ? level.vertex_count : level.tet_count;
}

std::uint32_t slots(std::uint32_t beam_kind) {
  return FACE_QUARTERS * (beam_kind == gpu::BEAM_LAMBERTIAN ? gpu::LAMBERTIAN_RAYS : 1);
}

std::uint64_t groups(const LevelBuffers& level, std::uint32_t beam_kind) {
  return (std::uint64_t{level.face_count} * slots(beam_kind) + WORKGROUP_SIZE - 1) / WORKGROUP_SIZE;
}

// Of one beam: every slot looks at its face; half the faces are lit, evenly, and a ray crosses ten tets, about as many
// as in marble at the finest level.
std::uint64_t walk_bytes(const LevelBuffers& level, std::uint32_t slot_count) {
  constexpr std::uint64_t tet_bytes =
      sizeof(glm::uvec4) + sizeof(std::uint32_t) + vec3_bytes + sizeof(gpu::Optical) + 2 * power_bytes;
  const std::uint64_t rays = slot_count / FACE_QUARTERS;
  return level.face_count * (slot_count * FACE_QUARTERS * vec3_bytes + rays * 10 * tet_bytes / 2);
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
  std::uint64_t sums_bytes = 0;
  for (const std::uint32_t kind : beams.kinds) sums_bytes += groups(level, kind) * sizeof(gpu::WalkSums);
  if (sums_.size() != sums_bytes) {
    sums_ = {context, sums_bytes, vk::Place::device, prefix_ + "walk sums"};
    sums_on_host_ = {context, sums_bytes, vk::Place::host, prefix_ + "walk sums, read back"};
  }
  work.recorder.fill(deposit, 0);
  work.recorder.fill(unscattered_, 0);
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
        .slots = slots(beams.kinds[beam]),
        .tet_count = level.tet_count,
        .fem = method == Method::fem ? 1u : 0u,
        .eta = static_cast<float>(eta)};
    work.recorder.dispatch(work.passes.walk_source, push, std::uint64_t{level.face_count} * push.slots, "source walk",
                           walk_bytes(level, push.slots));
    sums_offset += groups(level, beams.kinds[beam]) * sizeof(gpu::WalkSums);
  }
  work.recorder.copy(sums_, sums_on_host_, sums_bytes);
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
  WalkPower power;
  for (const gpu::WalkSums& sums : sums_on_host_.mapped_as<gpu::WalkSums>()) {
    power.scattered += glm::dvec3(sums.scattered);
    power.absorbed += glm::dvec3(sums.absorbed);
    power.unscattered += glm::dvec3(sums.unscattered);
  }
  return power;
}

}  // namespace quadgraph
