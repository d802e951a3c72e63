#include "engine/solve/forward_scattering.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "engine/solve/moved_bytes.h"
#include "interface/transport/transport_flow.comp.h"
#include "interface/transport/transport_flux.comp.h"
#include "interface/transport/transport_flux_load.comp.h"
#include "interface/transport/transport_optical.comp.h"
#include "interface/transport/transport_sooner.comp.h"

namespace quadgraph {
namespace {

constexpr std::uint64_t axes = 3, corners = 4;

// Of the tets around every vertex: each has four.
std::uint64_t around_bytes(const LevelBuffers& level) {
  return corners * level.tet_count * (sizeof(std::uint32_t) + sizeof(glm::uvec4) + sizeof(gpu::Optical));
}

// The phase function of Henyey and Greenstein up to a cosine, by s = sqrt(1 + g^2 - 2 g cosine): its share of all
// light, and that times the cosine, over `beside`.
struct HenyeyUpTo {
  double share, cosines, value;  // value: of the function there, 1 where light scatters evenly

  HenyeyUpTo(double g, double cosine, double beside) {
    const double s = std::sqrt(1 + g * g - 2 * g * cosine), first = (1 - g * g) / beside;
    share = first / (2 * g) * (1 / s - 1 / (1 + g));
    cosines = first / (4 * g * g) * ((1 + g * g) * (1 / s - 1 / (1 + g)) + s - (1 + g));
    value = first / (s * s * s);
  }
};

// Below this g the peak is nothing, and differences above lose what they are of.
constexpr double least_g = 1e-2;

// What light that scatters forwards is more than linear counts half: then no direction has less than next to nothing of
// it, and the lit side of balls is nearest to walks (docs/physics.md, "Light that scatters forwards").
constexpr double share_beyond = 0.5;

struct CutOff {
  double most = std::numeric_limits<float>::max(), mean, share = 1;
};

// Where the function is cut off, by halving, so that what is below and what is left of the rest make 1.
CutOff cut_off(double g) {
  if (g < least_g) return {.mean = g};
  const double beside = 1 - g * g;
  double low = -1, high = 1;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    const HenyeyUpTo there(g, middle, beside);
    (there.share + 0.5 * there.value * (1 - middle) < 1 ? low : high) = middle;
  }
  const HenyeyUpTo there(g, low, beside);
  return {.most = there.value, .mean = there.cosines + 0.25 * there.value * (1 - low * low), .share = share_beyond};
}

}  // namespace

gpu::BesidePeak beside_peak_of(const glm::vec3& g) {
  gpu::BesidePeak beside{.g = g, .most = {}, .mean = {}, .share = {}};
  for (int c = 0; c < 3; ++c) {
    const CutOff cut = cut_off(g[c]);
    beside.most[c] = static_cast<float>(cut.most);
    beside.mean[c] = static_cast<float>(cut.mean);
    beside.share[c] = static_cast<float>(cut.share);
  }
  return beside;
}

ForwardScattering::ForwardScattering(device::Device& device, const Level& level) {
  const auto room = [&](std::uint64_t bytes, const char* name) {
    return device::Buffer(device, bytes, device::Place::device, "transport/" + std::string(name));
  };
  const std::uint64_t flux = axes * level.vertex_count() * vec3_bytes, tets = level.tet_count();
  ref_ = room(sizeof(gpu::TransportForwardRef), "forward");
  optical_ = room(tets * sizeof(gpu::Optical), "coefficients beside the forward peak");
  towards_ = room(axes * tets * sum_bytes, "deposit by direction");
  leaving_ = room(level.face_count() * sum_bytes, "unscattered");
  flux_ = room(flux, "flux");
  flux_before_ = room(flux, "flux, before");
  flux_seen_ = room(flux, "flux, seen");
  flux_added_ = room(flux, "flux, added");
  flows_ = room(gpu::FLOWS * tets * vec3_bytes, "flows");
  flows_before_ = room(gpu::FLOWS_DIRECTION * tets * vec3_bytes, "flows, before");
  found_ = room(2 * axes * level.vertex_count() * sum_bytes, "flux, found");
  load_ = room(flux, "load of the flux");
  swept_ = room(flux, "flux, swept");
}

void ForwardScattering::write_ref(const ForwardParts& parts) {
  const LevelBuffers& level = parts.level;
  const gpu::TransportForwardRef ref{.vertices = level.vertices.address(),
                                     .tets = level.tets.address(),
                                     .optical = optical_.address(),
                                     .etendue = level.etendue.address(),
                                     .tet_offset = parts.tet_offset.address(),
                                     .tet_incidence = parts.tet_incidence.address(),
                                     .deposit = parts.deposit.address(),
                                     .towards = towards_.address(),
                                     .beside = beside_,
                                     .vertex_count = level.vertex_count,
                                     .tet_count = level.tet_count,
                                     .even = level.even ? 1u : 0u};
  device::write_bytes(parts.work.recorder.device(), ref_, std::as_bytes(std::span(&ref, 1)));
}

void ForwardScattering::record_start(const ForwardParts& parts, const glm::vec3& g) {
  beside_ = beside_peak_of(g);
  write_ref(parts);
  const LevelBuffers& level = parts.level;
  Workspace& work = parts.work;
  const gpu::TransportOpticalPush push{.optical = level.optical.address(),
                                       .beside = optical_.address(),
                                       .g = g,
                                       .count = level.even ? 1 : level.tet_count};
  work.recorder.dispatch(work.passes.of(shader::transport_optical), push, push.count, "transport start",
                         2 * push.count * sizeof(gpu::Optical));
  work.recorder.fill(towards_, 0);
  work.recorder.fill(leaving_, 0);
}

void ForwardScattering::record_sooner(const ForwardParts& parts, const SourceWalk& walk, const device::Buffer& mass,
                                      const device::Buffer& fluence, float share) {
  Workspace& work = parts.work;
  const gpu::TransportSoonerPush push{.forward = ref_.address(),
                                      .first = walk.first_deposit().address(),
                                      .all = walk.deposit(Method::fem).address(),
                                      .mass = mass.address(),
                                      .fluence = fluence.address(),
                                      .share = share};
  const std::uint32_t count = parts.level.vertex_count;
  work.recorder.dispatch(work.passes.of(shader::transport_sooner), push, count, "transport start",
                         around_bytes(parts.level) + parts.deposit.size() + count * (2 * sum_bytes + 3 * vec3_bytes));
}

void ForwardScattering::record_flux_of(const ForwardParts& parts, const FluxTask& task) {
  Workspace& work = parts.work;
  const gpu::TransportFluxPush push{.forward = ref_.address(),
                                    .a = task.a,
                                    .b = task.b,
                                    .gain = task.gain,
                                    .swept = task.swept,
                                    .flux = flux_.address(),
                                    .added = flux_added_.address(),
                                    .unit = parts.unit.address(),
                                    .scale = work.scale.address(),
                                    .keep = task.keep,
                                    .adds = task.adds};
  const std::uint32_t count = parts.level.vertex_count;
  const std::uint64_t first = push.swept == 0 ? corners * (parts.deposit.size() + towards_.size()) : swept_.size();
  work.recorder.dispatch(
      work.passes.of(shader::transport_flux), push, count, "transport flux",
      around_bytes(parts.level) + 12 * parts.level.tet_count * vec3_bytes + first + 4 * flux_.size());
}

void ForwardScattering::record_flux(const ForwardParts& parts, const device::Buffer& fluence, bool keep) {
  record_flux_of(parts, {.a = fluence.address(), .b = fluence.address(), .keep = keep ? 1.0f : 0.0f});
}

void ForwardScattering::record_flow(const ForwardParts& parts, float share, float keep) {
  Workspace& work = parts.work;
  const LevelBuffers& level = parts.level;
  const gpu::TransportFlowPush push{.forward = ref_.address(),
                                    .flux = flux_.address(),
                                    .flux_before = flux_before_.address(),
                                    .flux_seen = flux_seen_.address(),
                                    .flows = flows_.address(),
                                    .flows_before = flows_before_.address(),
                                    .unit = parts.unit.address(),
                                    .scale = work.scale.address(),
                                    .share = share,
                                    .keep = keep};
  work.recorder.dispatch(work.passes.of(shader::transport_flow), push, std::max(level.tet_count, level.vertex_count),
                         "transport flux",
                         4 * flux_.size() + flows_.size() + 2 * flows_before_.size() + parts.deposit.size() +
                             towards_.size() + level.tet_count * (sizeof(glm::uvec4) + corners * axes * vec3_bytes));
}

void ForwardScattering::record_nothing_found(const ForwardParts& parts) {
  parts.work.recorder.fill(found_, 0);
}

void ForwardScattering::record_load(const ForwardParts& parts, float share, float keep) {
  Workspace& work = parts.work;
  const gpu::TransportFluxLoadPush push{.found = found_.address(),
                                        .load = load_.address(),
                                        .unit = parts.unit.address(),
                                        .scale = work.scale.address(),
                                        .vertex_count = parts.level.vertex_count,
                                        .share = share,
                                        .keep = keep};
  work.recorder.dispatch(work.passes.of(shader::transport_flux_load), push, axes * parts.level.vertex_count,
                         "transport flux", found_.size() + 2 * load_.size());
}

void ForwardScattering::record_step(const ForwardParts& parts, const std::array<device::Buffer, 2>& change,
                                    std::uint64_t gain, bool adds) {
  record_flux_of(parts, {.a = change[0].address(),
                         .b = change[1].address(),
                         .gain = gain,
                         .swept = swept_.address(),
                         .adds = adds ? 1.0f : 0.0f});
}

}  // namespace quadgraph
