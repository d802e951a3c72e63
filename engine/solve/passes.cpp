#include "engine/solve/passes.h"

#include "shaders/assemble/assembly_shared.h"
#include "shaders/deform/deform_shared.h"
#include "shaders/exchange/exchange_shared.h"
#include "shaders/gather/gather_shared.h"
#include "shaders/material/edits.h"
#include "shaders/solver/packing.h"
#include "shaders/source/walk_shared.h"
#include "shaders/surface/surface_shared.h"
#include "spirv/assemble_edges.comp.h"
#include "spirv/assemble_edges_sp3.comp.h"
#include "spirv/assemble_even.comp.h"
#include "spirv/assemble_even_sp3.comp.h"
#include "spirv/assemble_fdm.comp.h"
#include "spirv/assemble_fdm_sp3.comp.h"
#include "spirv/assemble_fem.comp.h"
#include "spirv/assemble_fem_sp3.comp.h"
#include "spirv/assemble_fv.comp.h"
#include "spirv/assemble_fv_sp3.comp.h"
#include "spirv/assemble_polygrid.comp.h"
#include "spirv/assemble_polygrid_sp3.comp.h"
#include "spirv/cg_direction.comp.h"
#include "spirv/cg_direction_sp3.comp.h"
#include "spirv/cg_multiply.comp.h"
#include "spirv/cg_multiply_sp3.comp.h"
#include "spirv/cg_start.comp.h"
#include "spirv/cg_start_sp3.comp.h"
#include "spirv/cg_update.comp.h"
#include "spirv/cg_update_sp3.comp.h"
#include "spirv/chebyshev.comp.h"
#include "spirv/chebyshev_sp3.comp.h"
#include "spirv/coarse_solve.comp.h"
#include "spirv/coarse_solve_sp3.comp.h"
#include "spirv/correct.comp.h"
#include "spirv/correct_sp3.comp.h"
#include "spirv/deform.comp.h"
#include "spirv/deform_bounds.comp.h"
#include "spirv/deform_nodes.comp.h"
#include "spirv/deform_normals.comp.h"
#include "spirv/display_scale.comp.h"
#include "spirv/edit_material.comp.h"
#include "spirv/eigenvalue_bound.comp.h"
#include "spirv/eigenvalue_bound_sp3.comp.h"
#include "spirv/energy.comp.h"
#include "spirv/energy_sp3.comp.h"
#include "spirv/energy_total.comp.h"
#include "spirv/evaluate_material.comp.h"
#include "spirv/exchange.comp.h"
#include "spirv/exchange_boxes.comp.h"
#include "spirv/exchange_enter.comp.h"
#include "spirv/exchange_finer.comp.h"
#include "spirv/exchange_rays.comp.h"
#include "spirv/exitance.comp.h"
#include "spirv/exitance_sp3.comp.h"
#include "spirv/follow.comp.h"
#include "spirv/follow_sp3.comp.h"
#include "spirv/gather_exitance.comp.h"
#include "spirv/gather_nodes.comp.h"
#include "spirv/gather_phi.comp.h"
#include "spirv/gather_phi_sp3.comp.h"
#include "spirv/gather_scale.comp.h"
#include "spirv/gather_single.comp.h"
#include "spirv/grid_material.comp.h"
#include "spirv/irradiance_scale.comp.h"
#include "spirv/prolong.comp.h"
#include "spirv/prolong_sp3.comp.h"
#include "spirv/residual.comp.h"
#include "spirv/residual_sp3.comp.h"
#include "spirv/restrict.comp.h"
#include "spirv/restrict_sp3.comp.h"
#include "spirv/right_hand_side_buried.comp.h"
#include "spirv/right_hand_side_buried_sp3.comp.h"
#include "spirv/right_hand_side_fdm.comp.h"
#include "spirv/right_hand_side_fdm_sp3.comp.h"
#include "spirv/right_hand_side_fem.comp.h"
#include "spirv/right_hand_side_fem_sp3.comp.h"
#include "spirv/right_hand_side_fv.comp.h"
#include "spirv/right_hand_side_fv_sp3.comp.h"
#include "spirv/shape.comp.h"
#include "spirv/shape_state.comp.h"
#include "spirv/surface_change.comp.h"
#include "spirv/surface_change_sp3.comp.h"
#include "spirv/surface_share.comp.h"
#include "spirv/sweep.comp.h"
#include "spirv/sweep_sp3.comp.h"
#include "spirv/transfer.comp.h"
#include "spirv/transfer_sp3.comp.h"
#include "spirv/uncollided.comp.h"
#include "spirv/vertex_exitance.comp.h"
#include "spirv/vertex_unscattered.comp.h"
#include "spirv/walk_source.comp.h"

namespace quadgraph {

// SPIR-V of both models, the size of their push constants, a name, how they work, and which format of entries.
#define MODEL_PASSES(pass, Push, work, format)                       \
  {                                                                  \
    {pass##_comp, sizeof(gpu::Push), #pass, work, format}, {         \
      pass##_sp3_comp, sizeof(gpu::Push), #pass " sp3", work, format \
    }                                                                \
  }
#define MODEL_PASS(pass, Push, work) pass MODEL_PASSES(pass, Push, work, 0)
#define ENTRY_PASS(pass, Push, work)                                                              \
  pass {                                                                                          \
    MODEL_PASSES(pass, Push, work, ENTRIES_PACKED), MODEL_PASSES(pass, Push, work, ENTRIES_PLAIN) \
  }
#define ONE_PASS(pass, Push, work) pass(pass##_comp, sizeof(gpu::Push), #pass, work)

using enum vk::Work;

Passes::Passes()
    : ONE_PASS(evaluate_material, EvaluateMaterialPush, each),
      ONE_PASS(edit_material, EditMaterialPush, each),
      ONE_PASS(shape, ShapePush, each),
      ONE_PASS(irradiance_scale, IrradianceScalePush, reducing),
      ONE_PASS(walk_source, WalkSourcePush, each),
      ONE_PASS(vertex_exitance, VertexExitancePush, each),
      ONE_PASS(display_scale, DisplayScalePush, reducing),
      ONE_PASS(vertex_unscattered, VertexUnscatteredPush, each),
      ONE_PASS(energy_total, EnergyTotalPush, each),
      ONE_PASS(surface_share, SurfaceSharePush, each),
      ONE_PASS(uncollided, UncollidedPush, each),
      ONE_PASS(gather_exitance, GatherExitancePush, each),
      ONE_PASS(gather_nodes, GatherNodesPush, each),
      ONE_PASS(gather_scale, GatherScalePush, each),
      ONE_PASS(gather_single, GatherSinglePush, each),
      ONE_PASS(exchange, ExchangePush, each),
      ONE_PASS(exchange_finer, ExchangeFinerPush, each),
      ONE_PASS(exchange_enter, ExchangeEnterPush, each),
      ONE_PASS(exchange_boxes, ExchangeBoxesPush, each),
      ONE_PASS(exchange_rays, ExchangeRaysPush, each),
      ONE_PASS(deform, DeformPush, each),
      ONE_PASS(deform_nodes, DeformNodesPush, each),
      ONE_PASS(deform_normals, DeformNormalsPush, each),
      ONE_PASS(deform_bounds, DeformBoundsPush, each),
      ONE_PASS(shape_state, ShapeStatePush, strided),
      ONE_PASS(grid_material, GridMaterialPush, each),
      ENTRY_PASS(assemble_fdm, AssembleFdmPush, each),
      ENTRY_PASS(assemble_fv, AssembleFvPush, each),
      ENTRY_PASS(assemble_polygrid, AssemblePolygridPush, each),
      ENTRY_PASS(assemble_edges, AssembleEdgesPush, each),
      ENTRY_PASS(assemble_even, AssembleEvenPush, each),
      ENTRY_PASS(assemble_fem, AssembleFemPush, each),
      ENTRY_PASS(eigenvalue_bound, EigenvalueBoundPush, reducing),
      ENTRY_PASS(cg_start, CgStartPush, reducing),
      ENTRY_PASS(cg_multiply, CgMultiplyPush, reducing),
      ENTRY_PASS(cg_update, CgUpdatePush, reducing),
      ENTRY_PASS(cg_direction, CgDirectionPush, strided),
      ENTRY_PASS(sweep, SweepPush, reducing),
      ENTRY_PASS(residual, ResidualPush, strided),
      ENTRY_PASS(chebyshev, ChebyshevPush, reducing),
      ENTRY_PASS(coarse_solve, CoarseSolvePush, each),
      ENTRY_PASS(right_hand_side_fdm, RightHandSideFdmPush, each),
      ENTRY_PASS(right_hand_side_fv, RightHandSideFvPush, each),
      ENTRY_PASS(right_hand_side_fem, RightHandSideFemPush, each),
      ENTRY_PASS(right_hand_side_buried, RightHandSideBuriedPush, reducing),
      MODEL_PASS(transfer, TransferPush, each),
      MODEL_PASS(follow, FollowPush, each),
      MODEL_PASS(correct, CorrectPush, strided),
      MODEL_PASS(restrict, RestrictPush, strided),
      MODEL_PASS(prolong, ProlongPush, strided),
      MODEL_PASS(surface_change, SurfaceChangePush, reducing),
      MODEL_PASS(exitance, ExitancePush, reducing),
      MODEL_PASS(energy, EnergyPush, strided),
      MODEL_PASS(gather_phi, GatherPhiPush, each) {}

}  // namespace quadgraph
