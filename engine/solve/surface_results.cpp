#include "engine/solve/surface_results.h"

#include <algorithm>
#include <cmath>

#include "engine/graph/fresnel.h"

namespace quadgraph {
namespace {

constexpr std::uint64_t vec3_bytes = sizeof(glm::vec3);

std::uint32_t is_fem(Method method) {
  return method == Method::fem ? 1 : 0;
}

std::uint64_t energy_elements(const LevelBuffers& level) {
  return std::max(level.tet_count, level.face_count);
}

std::uint64_t energy_groups(const LevelBuffers& level) {
  return (energy_elements(level) + WORKGROUP_SIZE - 1) / WORKGROUP_SIZE;
}

// Share of the difference between two levels that is the finer one's own error: second order, spacing halved.
constexpr double fine_share = 1.0 / 3.0;

double relative(double difference, double whole) {
  return whole > 0 ? fine_share * std::sqrt(difference / whole) : 0.0;
}

}  // namespace

SurfaceResults::SurfaceResults(vk::Context& context, const LevelBuffers& level) {
  const auto vector = [&](std::uint64_t count, const char* name) {
    return vk::Buffer(context, count * vec3_bytes, vk::Place::device, name);
  };
  phi_ = vector(level.face_count, "phi at faces");
  exitance_ = vector(level.face_count, "exitance");
  coarse_exitance_ = vector(level.face_count, "exitance of the coarser level");
  vertex_exitance_ = vector(level.surface_vertex_count, "exitance at vertices");
  const std::uint64_t sums_bytes = energy_groups(level) * sizeof(gpu::EnergySums);
  sums_ = vk::Buffer(context, sums_bytes, vk::Place::device, "energy sums");
  sums_on_host_ = vk::Buffer(context, sums_bytes, vk::Place::host, "energy sums, read back");
}

void SurfaceResults::record_exitance(Workspace& work, const LevelBuffers& level, Method method, double eta,
                                     const OperatorBuffers& op, const vk::Buffer& exitance) {
  const gpu::ExitancePush push{level.faces.address(),
                               op.x.address(),
                               op.to_phi.address(),
                               level.q.address(),
                               work.scale.address(),
                               phi_.address(),
                               exitance.address(),
                               level.face_count,
                               level.tet_count,
                               is_fem(method),
                               static_cast<float>(mismatch(eta))};
  work.recorder.dispatch(work.passes.exitance, push, level.face_count, "exitance",
                         level.face_count * (sizeof(glm::uvec3) + 6 * vec3_bytes));
}

void SurfaceResults::record_coarse(Workspace& work, const LevelBuffers& level, Method method, double eta,
                                   const OperatorBuffers& op) {
  record_exitance(work, level, method, eta, op, coarse_exitance_);
}

void SurfaceResults::record_vertex_exitance(Workspace& work, const LevelBuffers& level, Method method, double eta,
                                            const OperatorBuffers& op) {
  const gpu::VertexExitancePush push{level.vertices.address(),
                                     level.faces.address(),
                                     op.face_offset.address(),
                                     op.face_incidence.address(),
                                     op.x.address(),
                                     level.q.address(),
                                     phi_.address(),
                                     work.scale.address(),
                                     vertex_exitance_.address(),
                                     level.surface_vertex_count,
                                     is_fem(method),
                                     static_cast<float>(mismatch(eta))};
  const std::uint64_t face_bytes = sizeof(glm::uvec2) + sizeof(glm::uvec3) + 5 * vec3_bytes;
  work.recorder.dispatch(work.passes.vertex_exitance, push, level.surface_vertex_count, "exitance",
                         3 * level.face_count * face_bytes + 2 * vec3_bytes * level.surface_vertex_count);
}

void SurfaceResults::record_energy(Workspace& work, const LevelBuffers& level, Method method,
                                   const OperatorBuffers& op) {
  const gpu::EnergyPush push{level.vertices.address(), level.tets.address(), level.faces.address(),
                             level.optical.address(),  op.x.address(),       op.to_phi.address(),
                             level.q.address(),        exitance_.address(),  coarse_exitance_.address(),
                             work.scale.address(),     sums_.address(),      level.tet_count,
                             level.face_count,         is_fem(method)};
  const std::uint64_t bytes = level.tet_count * (sizeof(glm::uvec4) + 9 * vec3_bytes) +
                              level.face_count * (sizeof(glm::uvec3) + 6 * vec3_bytes) + sums_.size();
  work.recorder.dispatch(work.passes.energy, push, energy_elements(level), "energy", bytes);
  work.recorder.copy(sums_, sums_on_host_, sums_.size());
}

void SurfaceResults::record(Workspace& work, const LevelBuffers& level, Method method, double eta,
                            const OperatorBuffers& op) {
  record_exitance(work, level, method, eta, op, exitance_);
  record_vertex_exitance(work, level, method, eta, op);
  record_energy(work, level, method, op);
}

Energy SurfaceResults::energy() const {
  Energy energy;
  for (const gpu::EnergySums& sums : sums_on_host_.mapped_as<gpu::EnergySums>()) {
    energy.entered += glm::dvec3(sums.entered);
    energy.scattered_out += glm::dvec3(sums.exitance);
    energy.absorbed += glm::dvec3(sums.absorbed);
  }
  return energy;
}

ErrorEstimate SurfaceResults::error() const {
  glm::dvec4 total{0};
  for (const gpu::EnergySums& sums : sums_on_host_.mapped_as<gpu::EnergySums>()) total += glm::dvec4(sums.error);
  return {.whole = relative(total.x, total.y), .unlit = relative(total.z, total.w)};
}

}  // namespace quadgraph
