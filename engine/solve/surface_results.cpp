#include "engine/solve/surface_results.h"

#include <algorithm>

#include "engine/solve/assembly.h"
#include "engine/solve/moved_bytes.h"
#include "interface/source/vertex_unscattered.comp.h"
#include "interface/surface/display_scale.comp.h"
#include "interface/surface/energy.comp.h"
#include "interface/surface/energy_total.comp.h"
#include "interface/surface/even_exitance.comp.h"
#include "interface/surface/even_faces.comp.h"
#include "interface/surface/exitance.comp.h"
#include "interface/surface/vertex_exitance.comp.h"
#include "interface/transport/transport_result.comp.h"
#include "shaders/surface/surface_shared.h"

namespace quadgraph {
namespace {

std::uint32_t is_on_vertices(Method method) {
  return on_vertices(method) ? 1 : 0;
}

std::uint64_t energy_elements(const LevelBuffers& level) {
  return std::max(level.tet_count, level.face_count);
}

std::uint32_t energy_groups(const LevelBuffers& level) {
  return static_cast<std::uint32_t>(device::workgroups(energy_elements(level)));
}

}  // namespace

FirstMoment first_moment_of(const OperatorBuffers& op) {
  return {.x = op.x.address(), .to_phi = op.to_phi.address(), .model = op.model};
}

void record_exitance(Workspace& work, const Solved& solved, const device::Buffer& phi, const device::Buffer& exitance,
                     const device::Buffer& clip) {
  const LevelBuffers& level = solved.level;
  const gpu::ExitancePush push{.vertices = level.vertices.address(),
                               .faces = level.faces.address(),
                               .face_kinds = level.face_kind.address(),
                               .boundaries = solved.boundaries.on_device,
                               .x = solved.op.x.address(),
                               .to_phi = solved.op.to_phi.address(),
                               .q = level.q.address(),
                               .scale = work.scale.address(),
                               .phi = phi.address(),
                               .exitance = exitance.address(),
                               .clip = clip.address(),
                               .reduction = work.reduction.address(),
                               .count = level.face_count,
                               .tet_count = level.tet_count,
                               .fem = is_on_vertices(solved.method),
                               .clipped = solved.walk != nullptr ? 1u : 0u};
  work.recorder.dispatch(work.passes.of(shader::exitance, solved.op.model), push, level.face_count, "exitance",
                         level.face_count * (sizeof(glm::uvec3) + 6 * vec3_bytes + 3 * solved.op.field_bytes()));
}

std::vector<glm::vec3> exitance_of(device::Device& device, Workspace& work, const Solved& solved) {
  const std::uint64_t bytes = solved.level.face_count * vec3_bytes;
  const device::Buffer phi(device, bytes, device::Place::device, "results/phi of a level");
  const device::Buffer exitance(device, bytes, device::Place::device, "results/exitance of a level");
  const device::Buffer clip(device, sizeof(gpu::Clip), device::Place::device, "results/clip of a level");
  record_exitance(work, solved, phi, exitance, clip);
  work.recorder.submit();
  return device::download<glm::vec3>(device, exitance);
}

SurfaceResults::SurfaceResults(device::Device& device, const LevelBuffers& level) {
  const auto vector = [&](std::uint64_t count, const char* name) {
    return device::Buffer(device, count * vec3_bytes, device::Place::device, name);
  };
  phi_ = vector(level.face_count, "results/phi at faces");
  exitance_ = vector(level.face_count, "results/exitance");
  vertex_exitance_ = vector(level.surface_vertex_count, "results/exitance at vertices");
  vertex_unscattered_ = vector(level.surface_vertex_count, "results/unscattered light at vertices");
  even_ =
      device::Buffer(device, level.face_count * sizeof(gpu::EvenFace), device::Place::device, "results/even exitance");
  face_area_ =
      device::Buffer(device, level.face_count * sizeof(float), device::Place::device, "results/areas of faces");
  display_factor_ = vector(1, "results/display factor");
  clip_ = device::Buffer(device, sizeof(gpu::Clip), device::Place::device, "results/clip");
  clip_on_host_ = device::Buffer(device, sizeof(gpu::Clip), device::Place::host, "results/clip, read back");
  const std::uint64_t sums_bytes = energy_groups(level) * sizeof(gpu::EnergySums);
  sums_ = device::Buffer(device, sums_bytes, device::Place::device, "results/energy sums");
  constexpr std::uint64_t total_bytes = WORKGROUP_SIZE * sizeof(gpu::EnergySums);
  totals_ = device::Buffer(device, total_bytes, device::Place::device, "results/energy totals");
  totals_on_host_ = device::Buffer(device, total_bytes, device::Place::host, "results/energy totals, read back");
}

void SurfaceResults::record_vertex_exitance(Workspace& work, const LevelBuffers& level, const device::Buffer& faces,
                                            bool geometric) {
  const gpu::VertexExitancePush push{.face_area = face_area_.address(),
                                     .face_offset = level.face_offset.address(),
                                     .face_incidence = level.face_incidence.address(),
                                     .face_exitance = faces.address(),
                                     .exitance = vertex_exitance_.address(),
                                     .count = level.surface_vertex_count,
                                     .geometric = geometric ? 1u : 0u};
  constexpr std::uint64_t face_bytes = sizeof(std::uint32_t) + sizeof(float) + vec3_bytes;
  work.recorder.dispatch(work.passes.of(shader::vertex_exitance), push, level.surface_vertex_count, "exitance",
                         3 * level.face_count * face_bytes + vec3_bytes * level.surface_vertex_count);
}

// After the factor of the clip, which record_energy applies.
void SurfaceResults::record_even(Workspace& work, const Solved& solved) {
  if (solved.method != Method::fem || solved.walk == nullptr) return;
  const LevelBuffers& level = solved.level;
  const gpu::EvenFacesPush faces{.vertices = level.vertices.address(),
                                 .faces = level.faces.address(),
                                 .face_tets = level.face_tets.address(),
                                 .face_kinds = level.face_kind.address(),
                                 .optical = level.optical.address(),
                                 .q = level.q.address(),
                                 .exitance = exitance_.address(),
                                 .even = even_.address(),
                                 .count = level.face_count,
                                 .same_everywhere = level.even ? 1u : 0u};
  work.recorder.dispatch(work.passes.of(shader::even_faces), faces, level.face_count, "even exitance",
                         level.face_count * (sizeof(glm::uvec3) + sizeof(std::uint32_t) + 5 * vec3_bytes +
                                             sizeof(gpu::Optical) + sizeof(gpu::EvenFace)));
  const gpu::EvenExitancePush exitance{.faces = level.faces.address(),
                                       .face_kinds = level.face_kind.address(),
                                       .face_offset = level.face_offset.address(),
                                       .face_incidence = level.face_incidence.address(),
                                       .even = even_.address(),
                                       .exitance = exitance_.address(),
                                       .count = level.face_count};
  constexpr std::uint64_t faces_around = 18;
  work.recorder.dispatch(work.passes.of(shader::even_exitance), exitance, level.face_count, "even exitance",
                         level.face_count * faces_around * (sizeof(std::uint32_t) + sizeof(gpu::EvenFace)));
}

void SurfaceResults::record_display_scale(Workspace& work, const LevelBuffers& level) {
  const gpu::DisplayScalePush push{.face_area = face_area_.address(),
                                   .faces = level.faces.address(),
                                   .face_kinds = level.face_kind.address(),
                                   .exitance = exitance_.address(),
                                   .vertex_exitance = vertex_exitance_.address(),
                                   .scale = work.scale.address(),
                                   .factor = display_factor_.address(),
                                   .reduction = work.reduction.address(),
                                   .count = level.face_count};
  work.recorder.dispatch(
      work.passes.of(shader::display_scale), push, level.face_count, "exitance",
      level.face_count * (sizeof(glm::uvec3) + sizeof(std::uint32_t) + sizeof(float) + 4 * vec3_bytes));
}

// For the picture: local means of a Galerkin solution are far better than its values, which on irregular tets two mean
// free paths long scatter by 5 to 7% from vertex to vertex. The mean over the faces around a vertex leaves 2%; a second
// round would leave 1%, and blur veins of a few elements. A geometric mean, because an arithmetic one carries light
// across the terminator, where exitance falls by an order of magnitude within a few elements.
void SurfaceResults::record_display(Workspace& work, const Solved& solved) {
  if (solved.walk == nullptr) {
    work.recorder.fill(vertex_unscattered_, 0);
    return record_vertex_exitance(work, solved.level, exitance_, false);
  }
  record_vertex_exitance(work, solved.level, exitance_, true);
  record_display_scale(work, solved.level);
  record_vertex_unscattered(work, solved);
}

void SurfaceResults::record_vertex_unscattered(Workspace& work, const Solved& solved) {
  const LevelBuffers& level = solved.level;
  const std::uint64_t unscattered = solved.unscattered != 0 ? solved.unscattered : solved.walk->unscattered().address();
  const gpu::VertexUnscatteredPush push{.face_area = face_area_.address(),
                                        .face_offset = level.face_offset.address(),
                                        .face_incidence = level.face_incidence.address(),
                                        .unscattered = unscattered,
                                        .scale = work.scale.address(),
                                        .factor = display_factor_.address(),
                                        .exitance = vertex_exitance_.address(),
                                        .vertex_unscattered = vertex_unscattered_.address(),
                                        .count = level.surface_vertex_count};
  constexpr std::uint64_t face_bytes = sizeof(std::uint32_t) * (1 + FIXED_WORDS) + sizeof(float);
  work.recorder.dispatch(work.passes.of(shader::vertex_unscattered), push, level.surface_vertex_count, "exitance",
                         3 * level.face_count * face_bytes + 3 * vec3_bytes * level.surface_vertex_count);
}

void SurfaceResults::record_energy(Workspace& work, const Solved& solved, const FirstMoment& fluence) {
  const LevelBuffers& level = solved.level;
  const gpu::EnergyPush push{
      .vertices = level.vertices.address(),
      .tets = level.tets.address(),
      .faces = level.faces.address(),
      .face_kinds = level.face_kind.address(),
      .optical = level.optical.address(),
      .etendue = conserves(solved.method) ? level.etendue.address() : 0,
      .x = fluence.x,
      .to_phi = fluence.to_phi,
      .q = level.q.address(),
      .exitance = exitance_.address(),
      .scale = work.scale.address(),
      .clip = clip_.address(),
      .face_area = face_area_.address(),
      .sums = sums_.address(),
      .tet_count = level.tet_count,
      .flags = (on_vertices(solved.method) ? gpu::ENERGY_ON_VERTICES : 0u) | (level.even ? gpu::ENERGY_EVEN : 0u),
      .least = level.least};
  const std::uint64_t bytes = level.tet_count * (sizeof(glm::uvec4) + 5 * vec3_bytes + 4 * solved.op.field_bytes()) +
                              level.face_count * (sizeof(glm::uvec3) + sizeof(float) + 6 * vec3_bytes) + sums_.size();
  work.recorder.dispatch(work.passes.of(shader::energy, fluence.model), push, energy_elements(level), "energy", bytes);
  const std::uint32_t groups = energy_groups(level);
  const gpu::EnergyTotalPush total{sums_.address(), totals_.address(), groups};
  work.recorder.dispatch(work.passes.of(shader::energy_total), total, WORKGROUP_SIZE, "energy",
                         sums_.size() + totals_.size());
  work.recorder.copy(totals_, totals_on_host_, totals_.size());
  work.recorder.copy(clip_, clip_on_host_, clip_.size());
}

void SurfaceResults::record(Workspace& work, const Solved& solved) {
  record_exitance(work, solved, phi_, exitance_, clip_);
  record_energy(work, solved, first_moment_of(solved.op));
  record_even(work, solved);
  record_display(work, solved);
}

void SurfaceResults::record_corrected(Workspace& work, const Solved& solved, const device::Buffer& fluence,
                                      const device::Buffer& exitance, const ErrorEstimate& taken) {
  const LevelBuffers& level = solved.level;
  const gpu::TransportResultPush push{.vertices = level.vertices.address(),
                                      .faces = level.faces.address(),
                                      .face_kinds = level.face_kind.address(),
                                      .fluence = fluence.address(),
                                      .scale = work.scale.address(),
                                      .corrected = exitance.address(),
                                      .phi = phi_.address(),
                                      .q = level.q.address(),
                                      .exitance = exitance_.address(),
                                      .clip = clip_.address(),
                                      .reduction = work.reduction.address(),
                                      .count = level.face_count,
                                      .taken_lit = static_cast<float>(taken.whole),
                                      .taken_unlit = static_cast<float>(taken.unlit)};
  work.recorder.dispatch(work.passes.of(shader::transport_result), push, level.face_count, "exitance",
                         level.face_count * (sizeof(glm::uvec3) + 11 * vec3_bytes));
  record_energy(work, solved, {.x = fluence.address()});
  record_even(work, solved);
  record_display(work, solved);
}

Energy SurfaceResults::energy() const {
  Energy energy;
  for (const gpu::EnergySums& sums : totals_on_host_.mapped_as<gpu::EnergySums>()) {
    energy.entered += glm::dvec3(sums.entered);
    energy.scattered_out += glm::dvec3(sums.exitance);
    energy.absorbed += glm::dvec3(sums.absorbed);
  }
  return energy;
}

glm::dvec3 SurfaceResults::clipped() const {
  return glm::dvec3(clip_on_host_.mapped_as<gpu::Clip>()[0].share);
}

}  // namespace quadgraph
