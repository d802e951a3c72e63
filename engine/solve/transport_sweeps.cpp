// The samples of a sweep, and what it makes of them.
#include <cstddef>

#include "engine/solve/moved_bytes.h"
#include "engine/solve/transport_samples.h"
#include "interface/transport/transport_mean.comp.h"
#include "interface/transport/transport_smooth.comp.h"
#include "interface/transport/transport_step.comp.h"
#include "interface/transport/transport_sweep.comp.h"
#include "interface/transport/transport_sweep_forward.comp.h"

namespace quadgraph {
void TransportSamples::record_sweep(const TransportParts& parts, std::uint32_t directions, std::uint32_t wanted) {
  Workspace& work = parts.work;
  const std::uint64_t segments = std::uint64_t{wanted} * directions * tets_per_ray;
  if (parts.forward()) {
    const gpu::TransportSweepForwardPush forward{.field = field_.address(),
                                                 .forward = forward_->ref().address(),
                                                 .drawn = drawn_.address(),
                                                 .points = points_.address(),
                                                 .fluence = fluence_seen_.address(),
                                                 .flux = forward_->flux_seen().address(),
                                                 .sums = point_sums_.address(),
                                                 .load = load_.address(),
                                                 .found = forward_->found().address(),
                                                 .room = room_,
                                                 .directions = directions,
                                                 .seed = seed_};
    work.recorder.dispatch(work.passes.of(shader::transport_sweep_forward), forward, room_for(wanted),
                           "transport sweep", segments * (segment_bytes + flow_bytes));
    return;
  }
  const gpu::TransportSweepPush sweep{.field = field_.address(),
                                      .drawn = drawn_.address(),
                                      .points = points_.address(),
                                      .fluence = fluence_seen_.address(),
                                      .fluence_before = fluence_apart_.address(),
                                      .sums = point_sums_.address(),
                                      .load = load_.address(),
                                      .room = room_,
                                      .directions = directions,
                                      .vertex_count = parts.level.vertex_count,
                                      .seed = seed_};
  work.recorder.dispatch(work.passes.of(shader::transport_sweep), sweep, room_for(wanted), "transport sweep",
                         segments * segment_bytes);
}

void TransportSamples::record_smooth(const TransportParts& parts, std::uint64_t mass, std::uint64_t from,
                                     std::uint64_t to) {
  Workspace& work = parts.work;
  const LevelBuffers& level = parts.level;
  const gpu::TransportSmoothPush push{.vertices = level.vertices.address(),
                                      .tets = level.tets.address(),
                                      .tet_offset = tet_offset_.address(),
                                      .tet_incidence = tet_incidence_.address(),
                                      .mass = mass,
                                      .from = from,
                                      .to = to,
                                      .count = level.vertex_count};
  work.recorder.dispatch(work.passes.of(shader::transport_smooth), push, level.vertex_count, "transport step",
                         4 * level.tet_count * (sizeof(glm::uvec4) + 8 * vec3_bytes));
}

void TransportSamples::record_step(const TransportParts& parts, const std::array<device::Buffer, 2>& load,
                                   const std::array<device::Buffer, 2>& change, const TransportShares& shares,
                                   float share) {
  Workspace& work = parts.work;
  const std::uint32_t count = parts.level.vertex_count;
  const gpu::TransportMeanPush mean{load[0].address(), load[1].address(), swept_[0].address(), count};
  work.recorder.dispatch(work.passes.of(shader::transport_mean), mean, count, "transport step", 3 * count * vec3_bytes);
  record_smooth(parts, mass_.address(), swept_[0].address(), swept_[1].address());
  record_smooth(parts, 0, swept_[1].address(), swept_[0].address());
  const gpu::TransportStepPush step{.swept = swept_[0].address(),
                                    .change_a = change[0].address(),
                                    .change_b = change[1].address(),
                                    .books = books_.address(),
                                    .fluence = fluence_.address(),
                                    .added = added_.address(),
                                    .count = count,
                                    .adds = shares.adds ? 1.0f : 0.0f};
  work.recorder.dispatch(work.passes.of(shader::transport_step), step, count, "transport step", 7 * count * vec3_bytes);
  if (parts.forward()) record_flux_step(parts, change, shares, share);
}

// The same of the flux, axis by axis, of both halves together.
void TransportSamples::record_flux_step(const TransportParts& parts, const std::array<device::Buffer, 2>& change,
                                        const TransportShares& shares, float share) {
  const ForwardParts forward = forward_parts(parts);
  forward_->record_load(forward, share / gpu::TRANSPORT_HALVES, shares.known);
  const std::uint64_t axis = std::uint64_t{parts.level.vertex_count} * vec3_bytes;
  for (std::uint64_t at = 0; at < 3 * axis; at += axis) {
    record_smooth(parts, mass_.address(), forward_->load().address() + at, swept_[0].address());
    record_smooth(parts, 0, swept_[0].address(), forward_->swept().address() + at);
  }
  forward_->record_step(forward, change, books_.address() + offsetof(gpu::TransportBook, gain), shares.adds);
}

// The fluence of the solve has what that counts as unscattered; of what counts, rays know better.
void TransportSamples::record_taken(const TransportParts& parts, const OperatorBuffers& op, double share) {
  const auto taken = static_cast<float>(share);
  record_fluence(parts, op, {.keep = 0, .taken = taken, .swept = 1});
  if (parts.forward()) forward_->record_sooner(forward_parts(parts), parts.walk, mass_, fluence_, 1 - taken);
}

}  // namespace quadgraph
