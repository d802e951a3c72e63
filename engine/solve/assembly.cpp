#include "engine/solve/assembly.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "engine/solve/moved_bytes.h"
#include "interface/assemble/assemble_edges.comp.h"
#include "interface/assemble/assemble_even.comp.h"
#include "interface/assemble/assemble_fdm.comp.h"
#include "interface/assemble/assemble_fem.comp.h"
#include "interface/assemble/assemble_fv.comp.h"
#include "interface/assemble/assemble_polygrid.comp.h"
#include "interface/assemble/eigenvalue_bound.comp.h"
#include "interface/assemble/grid_material.comp.h"
#include "interface/assemble/irradiance_scale.comp.h"
#include "interface/assemble/majorant.comp.h"
#include "interface/assemble/right_hand_side_fdm.comp.h"
#include "interface/assemble/right_hand_side_fem.comp.h"
#include "interface/assemble/right_hand_side_fv.comp.h"
#include "interface/assemble/shape.comp.h"
#include "interface/material/edit_material.comp.h"
#include "interface/material/evaluate_material.comp.h"
#include "shaders/assemble/assembly_shared.h"
#include "shaders/material/edits.h"

namespace quadgraph {
namespace {

// More would gain less than they cost: the bound goes from 3.1 to 2.6 in five steps, and to 2.55 in ten.
constexpr std::uint32_t bound_steps = 5;

void assemble_fdm(Workspace& work, const LevelBuffers& level, const BodyBoundaries& boundaries, OperatorBuffers& op) {
  const gpu::AssembleFdmPush push{.rows = op.rows(),
                                  .nodes = level.nodes.address(),
                                  .optical = level.optical.address(),
                                  .to_phi = op.to_phi.address(),
                                  .face_kinds = level.face_kind.address(),
                                  .boundaries = boundaries.on_device,
                                  .count = op.count,
                                  .tet_count = level.tet_count};
  const std::uint64_t bytes = op.entries * (vec3_bytes + 2 * op.entry_bytes()) +
                              op.count * (2 * vec3_bytes + sizeof(gpu::Optical) + op.row_bytes());
  work.recorder.dispatch(work.passes.of(shader::assemble_fdm, op.model, op.format), push, op.count, "assembly", bytes);
}

void assemble_fv(Workspace& work, const LevelBuffers& level, const BodyBoundaries& boundaries, OperatorBuffers& op) {
  const gpu::AssembleFvPush push{.rows = op.rows(),
                                 .vertices = level.vertices.address(),
                                 .tets = level.tets.address(),
                                 .links = level.links.address(),
                                 .nodes = level.nodes.address(),
                                 .optical = level.optical.address(),
                                 .etendue = level.etendue.address(),
                                 .to_phi = op.to_phi.address(),
                                 .face_kinds = level.face_kind.address(),
                                 .boundaries = boundaries.on_device,
                                 .count = op.count,
                                 .tet_count = level.tet_count,
                                 .least = level.least};
  const std::uint64_t link_bytes =
      2 * sizeof(glm::uvec4) + 5 * vec3_bytes + 2 * sizeof(gpu::Optical) + 2 * op.entry_bytes();
  work.recorder.dispatch(work.passes.of(shader::assemble_fv, op.model, op.format), push, op.count, "assembly",
                         op.entries * link_bytes + op.count * (vec3_bytes + sizeof(gpu::Optical) + op.row_bytes()) +
                             level.tet_count * (sizeof(glm::uvec4) + 4 * vec3_bytes));
}

void measure(Workspace& work, const LevelBuffers& level, LevelElements& elements) {
  const gpu::ShapePush push{.vertices = level.vertices.address(),
                            .tets = level.tets.address(),
                            .faces = level.faces.address(),
                            .etendue = level.etendue.address(),
                            .tet_shape = elements.tet_shape.address(),
                            .face_area = elements.face_area.address(),
                            .tet_count = level.tet_count,
                            .face_count = level.face_count,
                            .least = level.least};
  const std::uint64_t bytes = level.tet_count * (sizeof(glm::uvec4) + 4 * vec3_bytes + gpu::TET_SHAPE * sizeof(float)) +
                              level.face_count * (sizeof(glm::uvec3) + 3 * vec3_bytes + sizeof(float));
  work.recorder.dispatch(work.passes.of(shader::shape), push, std::max(level.tet_count, level.face_count), "shape",
                         bytes);
  elements.measured = true;
}

void assemble_even(Workspace& work, const LevelBuffers& level, const BodyBoundaries& boundaries, OperatorBuffers& op) {
  const LevelElements& elements = *op.elements;
  const gpu::AssembleEvenPush push{
      .rows = op.rows(),
      .optical = level.optical.address(),
      .entry_shape = elements.entry_shape.address(),
      .entry_area = elements.entry_area.address(),
      .row_shape = elements.row_shape.address(),
      .boundaries = boundaries.on_device,
      .count = op.count,
      .area_count = static_cast<std::uint32_t>(elements.entry_area.size() / sizeof(float))};
  work.recorder.dispatch(work.passes.of(shader::assemble_even, op.model, op.format), push, op.count, "assembly",
                         elements.entry_shape.size() + elements.entry_area.size() + elements.row_shape.size() +
                             2 * op.entries * op.entry_bytes() + op.count * op.row_bytes());
}

void assemble_fem(Workspace& work, const LevelBuffers& level, const BodyBoundaries& boundaries, bool even,
                  OperatorBuffers& op) {
  if (op.by_entry(even)) return assemble_even(work, level, boundaries, op);
  LevelElements& elements = *op.elements;
  if (!elements.measured) measure(work, level, elements);
  const gpu::AssembleEdgesPush edges{.rows = op.rows(),
                                     .optical = level.optical.address(),
                                     .tet_shape = elements.tet_shape.address(),
                                     .face_area = elements.face_area.address(),
                                     .edge_entry = elements.edge_entry.address(),
                                     .ring_offset = elements.ring_offset.address(),
                                     .ring = elements.ring.address(),
                                     .face_kinds = level.face_kind.address(),
                                     .boundaries = boundaries.on_device,
                                     .count = elements.edge_count,
                                     .even = even ? 1u : 0u};
  // Every tet is met at its six edges, then at its four corners.
  const std::uint64_t tet_bytes = index_bytes + (even ? 0 : sizeof(gpu::Optical)) + sizeof(float);
  const std::uint64_t face_bytes = index_bytes + sizeof(float);
  work.recorder.dispatch(work.passes.of(shader::assemble_edges, op.model, op.format), edges, elements.edge_count,
                         "assembly",
                         6 * level.tet_count * (tet_bytes + sizeof(float)) + 3 * level.face_count * face_bytes +
                             elements.edge_count * (3 * index_bytes + 4 * op.entry_bytes()));
  const gpu::AssembleFemPush push{.rows = op.rows(),
                                  .optical = level.optical.address(),
                                  .tet_shape = elements.tet_shape.address(),
                                  .face_area = elements.face_area.address(),
                                  .tet_offset = elements.tet_offset.address(),
                                  .tet_incidence = elements.tet_incidence.address(),
                                  .face_offset = level.face_offset.address(),
                                  .face_incidence = level.face_incidence.address(),
                                  .face_kinds = level.face_kind.address(),
                                  .boundaries = boundaries.on_device,
                                  .count = op.count,
                                  .surface_count = level.surface_vertex_count,
                                  .even = even ? 1u : 0u,
                                  .bodies = boundaries.bits()};
  work.recorder.dispatch(work.passes.of(shader::assemble_fem, op.model, op.format), push, op.count, "assembly",
                         4 * level.tet_count * tet_bytes + 3 * level.face_count * face_bytes +
                             2 * op.entries * op.entry_bytes() + op.count * op.row_bytes());
}

void assemble_polygrid(Workspace& work, const LevelBuffers& level, Method method, const BodyBoundaries& boundaries,
                       bool even, OperatorBuffers& op) {
  const gpu::GridMaterialPush material{.vertices = level.vertices.address(),
                                       .tets = level.tets.address(),
                                       .optical = level.optical.address(),
                                       .tet_offset = op.elements->tet_offset.address(),
                                       .tet_incidence = op.elements->tet_incidence.address(),
                                       .vertex_optical = op.grid_optical.address(),
                                       .volume = op.grid_volume.address(),
                                       .count = op.count,
                                       .even = even ? 1u : 0u,
                                       .least = level.least};
  const std::uint64_t tet_bytes = sizeof(glm::uvec4) + 4 * vec3_bytes + index_bytes + sizeof(gpu::Optical);
  work.recorder.dispatch(work.passes.of(shader::grid_material), material, op.count, "assembly",
                         4 * level.tet_count * tet_bytes + op.grid_optical.size() + op.grid_volume.size());
  const gpu::AssemblePolygridPush push{.rows = op.rows(),
                                       .vertices = level.vertices.address(),
                                       .faces = level.faces.address(),
                                       .face_offset = level.face_offset.address(),
                                       .face_incidence = level.face_incidence.address(),
                                       .optical = op.grid_optical.address(),
                                       .volume = op.grid_volume.address(),
                                       .to_phi = op.to_phi.address(),
                                       .boundaries = boundaries.on_device,
                                       .count = op.count,
                                       .surface_count = level.surface_vertex_count,
                                       .published = published(method) ? 1u : 0u};
  const std::uint64_t bytes = op.entries * (2 * op.entry_bytes() + vec3_bytes + sizeof(gpu::Optical)) +
                              op.count * (2 * vec3_bytes + sizeof(gpu::Optical) + sizeof(float) + op.row_bytes()) +
                              3 * level.face_count * (sizeof(glm::uvec3) + 3 * vec3_bytes + index_bytes);
  work.recorder.dispatch(work.passes.of(shader::assemble_polygrid, op.model, op.format), push, op.count, "assembly",
                         bytes);
}

// Every right-hand side reads the diagonal and writes b.
std::uint64_t right_hand_side_bytes(const OperatorBuffers& op) {
  return (op.block_bytes() + op.field_bytes()) * op.count;
}

void load_fdm(Workspace& work, const LevelBuffers& level, const BodyBoundaries& boundaries, OperatorBuffers& op) {
  const gpu::RightHandSideFdmPush push{.nodes = level.nodes.address(),
                                       .optical = level.optical.address(),
                                       .face_tets = level.face_tets.address(),
                                       .face_kinds = level.face_kind.address(),
                                       .boundaries = boundaries.on_device,
                                       .q = level.q.address(),
                                       .scale = work.scale.address(),
                                       .side = op.right_hand_side(work.reduction),
                                       .count = op.count,
                                       .tet_count = level.tet_count};
  const std::uint64_t face_bytes = 2 * index_bytes + 3 * vec3_bytes + 2 * sizeof(gpu::Optical);
  work.recorder.dispatch(work.passes.of(shader::right_hand_side_fdm, op.model, op.format), push, op.count,
                         "right-hand side", right_hand_side_bytes(op) + level.face_count * face_bytes);
}

void load_fv(Workspace& work, const LevelBuffers& level, const BodyBoundaries& boundaries, OperatorBuffers& op) {
  const gpu::RightHandSideFvPush push{.vertices = level.vertices.address(),
                                      .faces = level.faces.address(),
                                      .face_kinds = level.face_kind.address(),
                                      .boundaries = boundaries.on_device,
                                      .q = level.q.address(),
                                      .scale = work.scale.address(),
                                      .side = op.right_hand_side(work.reduction),
                                      .count = op.count,
                                      .tet_count = level.tet_count};
  const std::uint64_t face_bytes = sizeof(glm::uvec3) + 4 * vec3_bytes + index_bytes;
  work.recorder.dispatch(work.passes.of(shader::right_hand_side_fv, op.model, op.format), push, op.count,
                         "right-hand side", right_hand_side_bytes(op) + level.face_count * face_bytes);
}

// boundaries: their address, or 0 (RightHandSideFemPush).
void load_fem(Workspace& work, const LevelBuffers& level, std::uint64_t q, std::uint64_t boundaries,
              OperatorBuffers& op) {
  const gpu::RightHandSideFemPush push{.vertices = level.vertices.address(),
                                       .faces = level.faces.address(),
                                       .face_offset = level.face_offset.address(),
                                       .face_incidence = level.face_incidence.address(),
                                       .face_kinds = level.face_kind.address(),
                                       .boundaries = boundaries,
                                       .q = q,
                                       .scale = work.scale.address(),
                                       .side = op.right_hand_side(work.reduction),
                                       .count = op.count,
                                       .surface_count = level.surface_vertex_count};
  const std::uint64_t face_bytes = index_bytes + sizeof(glm::uvec3) + 4 * vec3_bytes;
  work.recorder.dispatch(work.passes.of(shader::right_hand_side_fem, op.model, op.format), push, op.count,
                         "right-hand side", right_hand_side_bytes(op) + 3 * level.face_count * face_bytes);
}

}  // namespace

void record_material(Workspace& work, const LevelBuffers& level, const gpu::Material& material,
                     const device::Buffer* depth, std::uint32_t count) {
  const gpu::EvaluateMaterialPush push{material, level.rest.address(), depth ? depth->address() : 0,
                                       level.optical.address(), count};
  work.recorder.dispatch(work.passes.of(shader::evaluate_material), push, count, "material",
                         count * (vec3_bytes + sizeof(gpu::Optical)));
}

void record_edits(Workspace& work, const LevelBuffers& level, const device::Buffer& base, const EditBuffers& edits,
                  const device::Buffer* depth, float spacing, std::uint32_t count) {
  const gpu::EditMaterialPush push{base.address(),
                                   level.optical.address(),
                                   level.rest.address(),
                                   depth ? depth->address() : 0,
                                   edits.edits.address(),
                                   edits.points.address(),
                                   edits.texels.address(),
                                   spacing,
                                   edits.count,
                                   depth ? 1u : 0u,
                                   count};
  work.recorder.dispatch(work.passes.of(shader::edit_material), push, count, "material edits",
                         count * (vec3_bytes + 2 * sizeof(gpu::Optical)));
}

void record_assembly(Workspace& work, const LevelBuffers& level, Method method, const BodyBoundaries& boundaries,
                     bool even, OperatorBuffers& op) {
  switch (method) {
    case Method::quadgraph_fdm:
      return assemble_fdm(work, level, boundaries, op);
    case Method::quadgraph_fv:
      return assemble_fv(work, level, boundaries, op);
    case Method::fem:
      return assemble_fem(work, level, boundaries, even, op);
    case Method::polygrid:
    case Method::polygrid_divergence:
      return assemble_polygrid(work, level, method, boundaries, even, op);
    case Method::shortest_path:
      break;  // refused by Simulation::solve
  }
}

void record_rows(Workspace& work, const LevelBuffers& level, Method method, const BodyBoundaries& boundaries, bool even,
                 StepBound bound, OperatorBuffers& op) {
  if (!op.assembled || *op.assembled != boundaries.of_body) {
    record_assembly(work, level, method, boundaries, even, op);
    op.assembled = boundaries.of_body;
    op.damped = op.majorised = false;
    op.weighed = false;
    op.loaded.reset();
  }
  if (!op.damped && bound == StepBound::damping) {
    record_damping(work, method, op);
    op.damped = true;
  }
  if (!op.majorised && bound == StepBound::majorant) {
    record_majorant(work, op);
    op.majorised = true;
  }
}

void record_scale(Workspace& work, const LevelBuffers& finest) {
  const gpu::IrradianceScalePush push{.vertices = finest.vertices.address(),
                                      .faces = finest.faces.address(),
                                      .face_kinds = finest.face_kind.address(),
                                      .q = finest.q.address(),
                                      .scale = work.scale.address(),
                                      .reduction = work.reduction.address(),
                                      .count = finest.face_count};
  work.recorder.dispatch(work.passes.of(shader::irradiance_scale), push, finest.face_count, "right-hand side",
                         finest.face_count * (sizeof(glm::uvec3) + 4 * vec3_bytes));
}

void record_diffuse_load(Workspace& work, const LevelBuffers& level, Method method, const BodyBoundaries& boundaries,
                         OperatorBuffers& op) {
  switch (traits_of(method).discretisation) {
    case Discretisation::fdm:
      return load_fdm(work, level, boundaries, op);
    case Discretisation::fv:
      return load_fv(work, level, boundaries, op);
    case Discretisation::fem:
    case Discretisation::polygrid:
      return load_fem(work, level, level.q.address(), boundaries.on_device, op);
    case Discretisation::none:
      break;
  }
}

void record_surface_load(Workspace& work, const LevelBuffers& level, std::uint64_t q, OperatorBuffers& op) {
  load_fem(work, level, q, 0, op);
}

void record_damping(Workspace& work, Method method, OperatorBuffers& op) {
  if (method != Method::fem) {
    work.recorder.fill(op.damping, std::bit_cast<std::uint32_t>(1.0f));
    return;
  }
  const device::Buffer* y = &op.z;
  const device::Buffer* z = &op.product;
  for (std::uint32_t step = 0; step < bound_steps; ++step) {
    const gpu::EigenvalueBoundPush push{.rows = op.rows(),
                                        .y = y->address(),
                                        .z = z->address(),
                                        .damping = op.damping.address(),
                                        .reduction = work.reduction.address(),
                                        .count = op.count,
                                        .first = step == 0 ? 1u : 0u};
    work.recorder.dispatch(work.passes.of(shader::eigenvalue_bound, op.model, op.format), push, op.count,
                           "eigenvalue bound",
                           op.product_bytes() + op.count * (op.block_bytes() + 2 * op.field_bytes()));
    std::swap(y, z);
  }
}

void record_majorant(Workspace& work, OperatorBuffers& op) {
  const gpu::MajorantPush push{.rows = op.rows(), .majorant = op.majorant.address(), .count = op.count};
  work.recorder.dispatch(work.passes.of(shader::majorant, op.model, op.format), push, op.count, "eigenvalue bound",
                         op.entries * op.entry_bytes() + op.count * (op.block_bytes() + op.majorant_bytes()));
}

}  // namespace quadgraph
