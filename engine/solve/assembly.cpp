#include "engine/solve/assembly.h"

#include <bit>

#include "engine/graph/fresnel.h"

namespace quadgraph {
namespace {

constexpr std::uint64_t vec3_bytes = sizeof(glm::vec3);
constexpr std::uint64_t index_bytes = sizeof(std::uint32_t);

// Every right-hand side reads the diagonal and writes b.
std::uint64_t row_bytes(const OperatorBuffers& op) {
  return 2 * vec3_bytes * op.count;
}

void assemble_fdm(Workspace& work, const LevelBuffers& level, float a, OperatorBuffers& op) {
  const gpu::AssembleFdmPush push{
      op.rows(), level.nodes.address(), level.optical.address(), op.to_phi.address(), op.count, level.tet_count, a};
  const std::uint64_t bytes =
      op.entries * (index_bytes + 2 * vec3_bytes) + op.count * (3 * vec3_bytes + sizeof(gpu::Optical));
  work.recorder.dispatch(work.passes.assemble_fdm, push, op.count, "assembly", bytes);
}

void assemble_fv(Workspace& work, const LevelBuffers& level, float a, OperatorBuffers& op) {
  const gpu::AssembleFvPush push{op.rows(),
                                 level.vertices.address(),
                                 level.tets.address(),
                                 level.links.address(),
                                 level.nodes.address(),
                                 level.optical.address(),
                                 op.to_phi.address(),
                                 op.count,
                                 level.tet_count,
                                 a};
  const std::uint64_t link_bytes = index_bytes + 2 * sizeof(glm::uvec4) + 6 * vec3_bytes + 2 * sizeof(gpu::Optical);
  work.recorder.dispatch(work.passes.assemble_fv, push, op.count, "assembly",
                         op.entries * link_bytes + op.count * (2 * vec3_bytes + sizeof(gpu::Optical)) +
                             level.tet_count * (sizeof(glm::uvec4) + 4 * vec3_bytes));
}

void assemble_fem(Workspace& work, const LevelBuffers& level, float a, OperatorBuffers& op) {
  const gpu::AssembleFemPush push{op.rows(),
                                  level.vertices.address(),
                                  level.tets.address(),
                                  level.faces.address(),
                                  level.optical.address(),
                                  op.tet_offset.address(),
                                  op.tet_incidence.address(),
                                  op.face_offset.address(),
                                  op.face_incidence.address(),
                                  op.count,
                                  level.surface_vertex_count,
                                  a};
  // Every tet is read from its four corners, every face from its three; an incidence adds to each other corner.
  const std::uint64_t tet_bytes = sizeof(glm::uvec2) + sizeof(glm::uvec4) + sizeof(gpu::Optical) + 10 * vec3_bytes;
  const std::uint64_t face_bytes = sizeof(glm::uvec2) + sizeof(glm::uvec3) + 7 * vec3_bytes;
  const std::uint64_t bytes = 4 * level.tet_count * tet_bytes + 3 * level.face_count * face_bytes +
                              op.entries * vec3_bytes + op.count * vec3_bytes;
  work.recorder.dispatch(work.passes.assemble_fem, push, op.count, "assembly", bytes);
}

void load_fdm(Workspace& work, const LevelBuffers& level, float a, float source, OperatorBuffers& op) {
  const gpu::RightHandSideFdmPush push{level.nodes.address(),
                                       level.optical.address(),
                                       level.face_tets.address(),
                                       level.q.address(),
                                       work.scale.address(),
                                       op.diagonal.address(),
                                       op.b.address(),
                                       op.state.address(),
                                       work.reduction.address(),
                                       op.count,
                                       level.tet_count,
                                       a,
                                       source};
  const std::uint64_t face_bytes = index_bytes + 3 * vec3_bytes + 2 * sizeof(gpu::Optical);
  work.recorder.dispatch(work.passes.right_hand_side_fdm, push, op.count, "right-hand side",
                         row_bytes(op) + level.face_count * face_bytes);
}

void load_fv(Workspace& work, const LevelBuffers& level, float a, float source, OperatorBuffers& op) {
  const gpu::RightHandSideFvPush push{level.vertices.address(),
                                      level.faces.address(),
                                      level.q.address(),
                                      work.scale.address(),
                                      op.diagonal.address(),
                                      op.b.address(),
                                      op.state.address(),
                                      work.reduction.address(),
                                      op.count,
                                      level.tet_count,
                                      a,
                                      source};
  const std::uint64_t face_bytes = sizeof(glm::uvec3) + 4 * vec3_bytes;
  work.recorder.dispatch(work.passes.right_hand_side_fv, push, op.count, "right-hand side",
                         row_bytes(op) + level.face_count * face_bytes);
}

void load_fem(Workspace& work, const LevelBuffers& level, float a, float source, OperatorBuffers& op) {
  const gpu::RightHandSideFemPush push{level.vertices.address(),
                                       level.faces.address(),
                                       op.face_offset.address(),
                                       op.face_incidence.address(),
                                       level.q.address(),
                                       work.scale.address(),
                                       op.diagonal.address(),
                                       op.b.address(),
                                       op.state.address(),
                                       work.reduction.address(),
                                       op.count,
                                       level.surface_vertex_count,
                                       a,
                                       source};
  const std::uint64_t face_bytes = sizeof(glm::uvec2) + sizeof(glm::uvec3) + 4 * vec3_bytes;
  work.recorder.dispatch(work.passes.right_hand_side_fem, push, op.count, "right-hand side",
                         row_bytes(op) + 3 * level.face_count * face_bytes);
}

}  // namespace

void record_material(Workspace& work, const LevelBuffers& level, const gpu::Material& material) {
  const gpu::EvaluateMaterialPush push{material, level.nodes.address(), level.optical.address(), level.node_count};
  work.recorder.dispatch(work.passes.evaluate_material, push, level.node_count, "material",
                         level.node_count * (vec3_bytes + sizeof(gpu::Optical)));
}

void record_assembly(Workspace& work, const LevelBuffers& level, Method method, double eta, OperatorBuffers& op) {
  const auto a = static_cast<float>(mismatch(eta));
  switch (method) {
    case Method::quadgraph_fdm:
      return assemble_fdm(work, level, a, op);
    case Method::quadgraph_fv:
      return assemble_fv(work, level, a, op);
    case Method::fem:
      return assemble_fem(work, level, a, op);
  }
}

void record_scale(Workspace& work, const LevelBuffers& finest) {
  const gpu::IrradianceScalePush push{finest.vertices.address(), finest.faces.address(),   finest.q.address(),
                                      work.scale.address(),      work.reduction.address(), finest.face_count};
  work.recorder.dispatch(work.passes.irradiance_scale, push, finest.face_count, "right-hand side",
                         finest.face_count * (sizeof(glm::uvec3) + 4 * vec3_bytes));
}

void record_right_hand_side(Workspace& work, const LevelBuffers& level, Method method, double eta,
                            OperatorBuffers& op) {
  const auto a = static_cast<float>(mismatch(eta));
  const auto source = static_cast<float>(4.0 / (1.0 - internal_diffuse_reflectance(eta)));  // Q / q
  switch (method) {
    case Method::quadgraph_fdm:
      return load_fdm(work, level, a, source, op);
    case Method::quadgraph_fv:
      return load_fv(work, level, a, source, op);
    case Method::fem:
      return load_fem(work, level, a, source, op);
  }
}

void record_damping(Workspace& work, Method method, OperatorBuffers& op) {
  if (method != Method::fem) {
    work.recorder.fill(op.damping, std::bit_cast<std::uint32_t>(1.0f));
    return;
  }
  const gpu::DampingPush push{op.rows(), op.damping.address(), work.reduction.address(), op.count};
  work.recorder.dispatch(work.passes.damping, push, op.count, "assembly",
                         op.entries * vec3_bytes + op.count * vec3_bytes);
}

}  // namespace quadgraph
