// The push constants of the passes of the solve are those of C++, in every variant.
#include "shaders/assemble/assembly_shared.h"
#include "shaders/material/edits.h"
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
#include "spirv/copy.comp.h"
#include "spirv/correct.comp.h"
#include "spirv/correct_sp3.comp.h"
#include "spirv/display_scale.comp.h"
#include "spirv/edit_material.comp.h"
#include "spirv/eigenvalue_bound.comp.h"
#include "spirv/eigenvalue_bound_sp3.comp.h"
#include "spirv/energy.comp.h"
#include "spirv/energy_sp3.comp.h"
#include "spirv/energy_total.comp.h"
#include "spirv/evaluate_material.comp.h"
#include "spirv/exitance.comp.h"
#include "spirv/exitance_sp3.comp.h"
#include "spirv/follow.comp.h"
#include "spirv/follow_sp3.comp.h"
#include "spirv/irradiance_scale.comp.h"
#include "spirv/prolong.comp.h"
#include "spirv/prolong_sp3.comp.h"
#include "spirv/residual.comp.h"
#include "spirv/residual_sp3.comp.h"
#include "spirv/restrict.comp.h"
#include "spirv/restrict_sp3.comp.h"
#include "spirv/right_hand_side_fdm.comp.h"
#include "spirv/right_hand_side_fdm_sp3.comp.h"
#include "spirv/right_hand_side_fem.comp.h"
#include "spirv/right_hand_side_fem_sp3.comp.h"
#include "spirv/right_hand_side_fv.comp.h"
#include "spirv/right_hand_side_fv_sp3.comp.h"
#include "spirv/shape.comp.h"
#include "spirv/surface_change.comp.h"
#include "spirv/surface_change_sp3.comp.h"
#include "spirv/surface_share.comp.h"
#include "spirv/sweep.comp.h"
#include "spirv/sweep_sp3.comp.h"
#include "spirv/transfer.comp.h"
#include "spirv/transfer_sp3.comp.h"
#include "spirv/vertex_exitance.comp.h"
#include "tests/cpp/fixtures/layout_compare.h"

using namespace quadgraph;

TEST_CASE("push constants") {
  compare(
      evaluate_material_comp, "EvaluateMaterialPush",
      {MEMBER(EvaluateMaterialPush, material), MEMBER(EvaluateMaterialPush, nodes), MEMBER(EvaluateMaterialPush, depth),
       MEMBER(EvaluateMaterialPush, optical), MEMBER(EvaluateMaterialPush, count)});
  compare(edit_material_comp, "EditMaterialPush",
          {MEMBER(EditMaterialPush, base), MEMBER(EditMaterialPush, optical), MEMBER(EditMaterialPush, nodes),
           MEMBER(EditMaterialPush, depth), MEMBER(EditMaterialPush, edits), MEMBER(EditMaterialPush, points),
           MEMBER(EditMaterialPush, texels), MEMBER(EditMaterialPush, spacing), MEMBER(EditMaterialPush, edit_count),
           MEMBER(EditMaterialPush, with_depth), MEMBER(EditMaterialPush, count)});
  compare(copy_comp, "CopyPush",
          {MEMBER(CopyPush, source), MEMBER(CopyPush, target), MEMBER(CopyPush, count), MEMBER(CopyPush, invocations)});
  compare(shape_comp, "ShapePush",
          {MEMBER(ShapePush, vertices), MEMBER(ShapePush, tets), MEMBER(ShapePush, faces), MEMBER(ShapePush, tet_shape),
           MEMBER(ShapePush, face_area), MEMBER(ShapePush, tet_count), MEMBER(ShapePush, face_count),
           MEMBER(ShapePush, least)});
  compare(irradiance_scale_comp, "IrradianceScalePush",
          {MEMBER(IrradianceScalePush, vertices), MEMBER(IrradianceScalePush, faces),
           MEMBER(IrradianceScalePush, face_kinds), MEMBER(IrradianceScalePush, q), MEMBER(IrradianceScalePush, scale),
           MEMBER(IrradianceScalePush, reduction), MEMBER(IrradianceScalePush, count)});
  compare(
      vertex_exitance_comp, "VertexExitancePush",
      {MEMBER(VertexExitancePush, vertices), MEMBER(VertexExitancePush, faces), MEMBER(VertexExitancePush, face_offset),
       MEMBER(VertexExitancePush, face_incidence), MEMBER(VertexExitancePush, face_exitance),
       MEMBER(VertexExitancePush, exitance), MEMBER(VertexExitancePush, count), MEMBER(VertexExitancePush, geometric)});
  compare(
      display_scale_comp, "DisplayScalePush",
      {MEMBER(DisplayScalePush, vertices), MEMBER(DisplayScalePush, faces), MEMBER(DisplayScalePush, face_kinds),
       MEMBER(DisplayScalePush, exitance), MEMBER(DisplayScalePush, vertex_exitance), MEMBER(DisplayScalePush, scale),
       MEMBER(DisplayScalePush, factor), MEMBER(DisplayScalePush, reduction), MEMBER(DisplayScalePush, count)});
  // Both variants of a pass read the same block.
  for (const vk::Spirv code : {vk::Spirv(assemble_fdm_comp), vk::Spirv(assemble_fdm_sp3_comp)}) {
    compare(code, "AssembleFdmPush",
            {MEMBER(AssembleFdmPush, rows), MEMBER(AssembleFdmPush, nodes), MEMBER(AssembleFdmPush, optical),
             MEMBER(AssembleFdmPush, to_phi), MEMBER(AssembleFdmPush, face_kinds), MEMBER(AssembleFdmPush, count),
             MEMBER(AssembleFdmPush, tet_count), MEMBER(AssembleFdmPush, boundary)});
  }
  for (const vk::Spirv code : {vk::Spirv(assemble_fv_comp), vk::Spirv(assemble_fv_sp3_comp)}) {
    compare(code, "AssembleFvPush",
            {MEMBER(AssembleFvPush, rows), MEMBER(AssembleFvPush, vertices), MEMBER(AssembleFvPush, tets),
             MEMBER(AssembleFvPush, links), MEMBER(AssembleFvPush, nodes), MEMBER(AssembleFvPush, optical),
             MEMBER(AssembleFvPush, to_phi), MEMBER(AssembleFvPush, face_kinds), MEMBER(AssembleFvPush, count),
             MEMBER(AssembleFvPush, tet_count), MEMBER(AssembleFvPush, least), MEMBER(AssembleFvPush, boundary)});
  }
  for (const vk::Spirv code : {vk::Spirv(assemble_edges_comp), vk::Spirv(assemble_edges_sp3_comp)}) {
    compare(code, "AssembleEdgesPush",
            {MEMBER(AssembleEdgesPush, rows), MEMBER(AssembleEdgesPush, optical), MEMBER(AssembleEdgesPush, tet_shape),
             MEMBER(AssembleEdgesPush, face_area), MEMBER(AssembleEdgesPush, edge_entry),
             MEMBER(AssembleEdgesPush, ring_offset), MEMBER(AssembleEdgesPush, ring), MEMBER(AssembleEdgesPush, count),
             MEMBER(AssembleEdgesPush, even), MEMBER(AssembleEdgesPush, boundary)});
  }
  for (const vk::Spirv code : {vk::Spirv(assemble_even_comp), vk::Spirv(assemble_even_sp3_comp)}) {
    compare(code, "AssembleEvenPush",
            {MEMBER(AssembleEvenPush, rows), MEMBER(AssembleEvenPush, optical), MEMBER(AssembleEvenPush, entry_shape),
             MEMBER(AssembleEvenPush, entry_area), MEMBER(AssembleEvenPush, row_shape), MEMBER(AssembleEvenPush, count),
             MEMBER(AssembleEvenPush, area_count), MEMBER(AssembleEvenPush, boundary)});
  }
  for (const vk::Spirv code : {vk::Spirv(assemble_fem_comp), vk::Spirv(assemble_fem_sp3_comp)}) {
    compare(code, "AssembleFemPush",
            {MEMBER(AssembleFemPush, rows), MEMBER(AssembleFemPush, optical), MEMBER(AssembleFemPush, tet_shape),
             MEMBER(AssembleFemPush, face_area), MEMBER(AssembleFemPush, tet_offset),
             MEMBER(AssembleFemPush, tet_incidence), MEMBER(AssembleFemPush, face_offset),
             MEMBER(AssembleFemPush, face_incidence), MEMBER(AssembleFemPush, count),
             MEMBER(AssembleFemPush, surface_count), MEMBER(AssembleFemPush, even), MEMBER(AssembleFemPush, boundary)});
  }
  for (const vk::Spirv code : {vk::Spirv(right_hand_side_fdm_comp), vk::Spirv(right_hand_side_fdm_sp3_comp)}) {
    compare(
        code, "RightHandSideFdmPush",
        {MEMBER(RightHandSideFdmPush, nodes), MEMBER(RightHandSideFdmPush, optical),
         MEMBER(RightHandSideFdmPush, face_tets), MEMBER(RightHandSideFdmPush, face_kinds),
         MEMBER(RightHandSideFdmPush, q), MEMBER(RightHandSideFdmPush, scale), MEMBER(RightHandSideFdmPush, diagonal),
         MEMBER(RightHandSideFdmPush, b), MEMBER(RightHandSideFdmPush, state), MEMBER(RightHandSideFdmPush, reduction),
         MEMBER(RightHandSideFdmPush, count), MEMBER(RightHandSideFdmPush, tet_count),
         MEMBER(RightHandSideFdmPush, boundary)});
  }
  for (const vk::Spirv code : {vk::Spirv(right_hand_side_fv_comp), vk::Spirv(right_hand_side_fv_sp3_comp)}) {
    compare(
        code, "RightHandSideFvPush",
        {MEMBER(RightHandSideFvPush, vertices), MEMBER(RightHandSideFvPush, faces),
         MEMBER(RightHandSideFvPush, face_kinds), MEMBER(RightHandSideFvPush, q), MEMBER(RightHandSideFvPush, scale),
         MEMBER(RightHandSideFvPush, diagonal), MEMBER(RightHandSideFvPush, b), MEMBER(RightHandSideFvPush, state),
         MEMBER(RightHandSideFvPush, reduction), MEMBER(RightHandSideFvPush, count),
         MEMBER(RightHandSideFvPush, tet_count), MEMBER(RightHandSideFvPush, boundary)});
  }
  for (const vk::Spirv code : {vk::Spirv(right_hand_side_fem_comp), vk::Spirv(right_hand_side_fem_sp3_comp)}) {
    compare(
        code, "RightHandSideFemPush",
        {MEMBER(RightHandSideFemPush, vertices), MEMBER(RightHandSideFemPush, faces),
         MEMBER(RightHandSideFemPush, face_offset), MEMBER(RightHandSideFemPush, face_incidence),
         MEMBER(RightHandSideFemPush, q), MEMBER(RightHandSideFemPush, scale), MEMBER(RightHandSideFemPush, diagonal),
         MEMBER(RightHandSideFemPush, b), MEMBER(RightHandSideFemPush, state), MEMBER(RightHandSideFemPush, reduction),
         MEMBER(RightHandSideFemPush, count), MEMBER(RightHandSideFemPush, surface_count),
         MEMBER(RightHandSideFemPush, boundary)});
  }
  for (const vk::Spirv code : {vk::Spirv(eigenvalue_bound_comp), vk::Spirv(eigenvalue_bound_sp3_comp)}) {
    compare(code, "EigenvalueBoundPush",
            {MEMBER(EigenvalueBoundPush, rows), MEMBER(EigenvalueBoundPush, y), MEMBER(EigenvalueBoundPush, z),
             MEMBER(EigenvalueBoundPush, damping), MEMBER(EigenvalueBoundPush, reduction),
             MEMBER(EigenvalueBoundPush, count), MEMBER(EigenvalueBoundPush, first)});
  }
  for (const vk::Spirv code : {vk::Spirv(transfer_comp), vk::Spirv(transfer_sp3_comp)}) {
    compare(code, "TransferPush",
            {MEMBER(TransferPush, index), MEMBER(TransferPush, weight), MEMBER(TransferPush, coarse_x),
             MEMBER(TransferPush, coarse_to_phi), MEMBER(TransferPush, to_phi), MEMBER(TransferPush, x),
             MEMBER(TransferPush, state), MEMBER(TransferPush, width), MEMBER(TransferPush, first),
             MEMBER(TransferPush, coarse_first), MEMBER(TransferPush, count)});
  }
  for (const vk::Spirv code : {vk::Spirv(cg_start_comp), vk::Spirv(cg_start_sp3_comp)}) {
    compare(
        code, "CgStartPush",
        {MEMBER(CgStartPush, rows), MEMBER(CgStartPush, b), MEMBER(CgStartPush, x), MEMBER(CgStartPush, r),
         MEMBER(CgStartPush, p), MEMBER(CgStartPush, state), MEMBER(CgStartPush, reduction), MEMBER(CgStartPush, count),
         MEMBER(CgStartPush, tolerance), MEMBER(CgStartPush, what), MEMBER(CgStartPush, multigrid)});
  }
  for (const vk::Spirv code : {vk::Spirv(cg_multiply_comp), vk::Spirv(cg_multiply_sp3_comp)}) {
    compare(code, "CgMultiplyPush",
            {MEMBER(CgMultiplyPush, rows), MEMBER(CgMultiplyPush, p), MEMBER(CgMultiplyPush, product),
             MEMBER(CgMultiplyPush, state), MEMBER(CgMultiplyPush, reduction), MEMBER(CgMultiplyPush, count)});
  }
  for (const vk::Spirv code : {vk::Spirv(cg_update_comp), vk::Spirv(cg_update_sp3_comp)}) {
    compare(code, "CgUpdatePush",
            {MEMBER(CgUpdatePush, diagonal), MEMBER(CgUpdatePush, p), MEMBER(CgUpdatePush, product),
             MEMBER(CgUpdatePush, x), MEMBER(CgUpdatePush, r), MEMBER(CgUpdatePush, state),
             MEMBER(CgUpdatePush, reduction), MEMBER(CgUpdatePush, count), MEMBER(CgUpdatePush, multigrid)});
  }
  for (const vk::Spirv code : {vk::Spirv(cg_direction_comp), vk::Spirv(cg_direction_sp3_comp)}) {
    compare(code, "CgDirectionPush",
            {MEMBER(CgDirectionPush, diagonal), MEMBER(CgDirectionPush, r), MEMBER(CgDirectionPush, z),
             MEMBER(CgDirectionPush, p), MEMBER(CgDirectionPush, state), MEMBER(CgDirectionPush, count),
             MEMBER(CgDirectionPush, multigrid)});
  }
  for (const vk::Spirv code : {vk::Spirv(sweep_comp), vk::Spirv(sweep_sp3_comp)}) {
    compare(code, "SweepPush",
            {MEMBER(SweepPush, rows), MEMBER(SweepPush, b), MEMBER(SweepPush, from), MEMBER(SweepPush, to),
             MEMBER(SweepPush, damping), MEMBER(SweepPush, state), MEMBER(SweepPush, reduction),
             MEMBER(SweepPush, count), MEMBER(SweepPush, sweeps)});
  }
  for (const vk::Spirv code : {vk::Spirv(exitance_comp), vk::Spirv(exitance_sp3_comp)}) {
    compare(
        code, "ExitancePush",
        {MEMBER(ExitancePush, vertices), MEMBER(ExitancePush, faces), MEMBER(ExitancePush, face_kinds),
         MEMBER(ExitancePush, x), MEMBER(ExitancePush, to_phi), MEMBER(ExitancePush, q), MEMBER(ExitancePush, scale),
         MEMBER(ExitancePush, phi), MEMBER(ExitancePush, exitance), MEMBER(ExitancePush, clip),
         MEMBER(ExitancePush, reduction), MEMBER(ExitancePush, count), MEMBER(ExitancePush, tet_count),
         MEMBER(ExitancePush, fem), MEMBER(ExitancePush, clipped), MEMBER(ExitancePush, boundary)});
  }
  for (const vk::Spirv code : {vk::Spirv(energy_comp), vk::Spirv(energy_sp3_comp)}) {
    compare(
        code, "EnergyPush",
        {MEMBER(EnergyPush, vertices), MEMBER(EnergyPush, tets), MEMBER(EnergyPush, faces),
         MEMBER(EnergyPush, face_kinds), MEMBER(EnergyPush, optical), MEMBER(EnergyPush, x), MEMBER(EnergyPush, to_phi),
         MEMBER(EnergyPush, q), MEMBER(EnergyPush, exitance), MEMBER(EnergyPush, scale), MEMBER(EnergyPush, clip),
         MEMBER(EnergyPush, sums), MEMBER(EnergyPush, tet_count), MEMBER(EnergyPush, face_count),
         MEMBER(EnergyPush, fem), MEMBER(EnergyPush, even), MEMBER(EnergyPush, least)});
  }
}

TEST_CASE("push constants of the cycles and of the looks at the surface") {
  compare(energy_total_comp, "EnergyTotalPush",
          {MEMBER(EnergyTotalPush, sums), MEMBER(EnergyTotalPush, total), MEMBER(EnergyTotalPush, count)});
  compare(surface_share_comp, "SurfaceSharePush",
          {MEMBER(SurfaceSharePush, vertices), MEMBER(SurfaceSharePush, faces), MEMBER(SurfaceSharePush, face_kinds),
           MEMBER(SurfaceSharePush, face_offset), MEMBER(SurfaceSharePush, face_incidence), MEMBER(SurfaceSharePush, q),
           MEMBER(SurfaceSharePush, scale), MEMBER(SurfaceSharePush, share), MEMBER(SurfaceSharePush, count),
           MEMBER(SurfaceSharePush, fem), MEMBER(SurfaceSharePush, reflected)});
  for (const vk::Spirv code : {vk::Spirv(correct_comp), vk::Spirv(correct_sp3_comp)}) {
    compare(code, "CorrectPush",
            {MEMBER(CorrectPush, z), MEMBER(CorrectPush, x), MEMBER(CorrectPush, state), MEMBER(CorrectPush, count)});
  }
  for (const vk::Spirv code : {vk::Spirv(follow_comp), vk::Spirv(follow_sp3_comp)}) {
    compare(code, "FollowPush",
            {MEMBER(FollowPush, index), MEMBER(FollowPush, weight), MEMBER(FollowPush, coarse_x),
             MEMBER(FollowPush, coarse_before), MEMBER(FollowPush, coarse_to_phi), MEMBER(FollowPush, to_phi),
             MEMBER(FollowPush, x), MEMBER(FollowPush, before), MEMBER(FollowPush, unit), MEMBER(FollowPush, scale),
             MEMBER(FollowPush, width), MEMBER(FollowPush, first), MEMBER(FollowPush, coarse_first),
             MEMBER(FollowPush, count), MEMBER(FollowPush, has_coarse), MEMBER(FollowPush, keep_before)});
  }
  for (const vk::Spirv code : {vk::Spirv(residual_comp), vk::Spirv(residual_sp3_comp)}) {
    compare(code, "ResidualPush",
            {MEMBER(ResidualPush, rows), MEMBER(ResidualPush, f), MEMBER(ResidualPush, x), MEMBER(ResidualPush, r),
             MEMBER(ResidualPush, count)});
  }
  for (const vk::Spirv code : {vk::Spirv(chebyshev_comp), vk::Spirv(chebyshev_sp3_comp)}) {
    compare(code, "ChebyshevPush",
            {MEMBER(ChebyshevPush, rows), MEMBER(ChebyshevPush, f), MEMBER(ChebyshevPush, from),
             MEMBER(ChebyshevPush, to), MEMBER(ChebyshevPush, d), MEMBER(ChebyshevPush, damping),
             MEMBER(ChebyshevPush, state), MEMBER(ChebyshevPush, reduction), MEMBER(ChebyshevPush, count),
             MEMBER(ChebyshevPush, first), MEMBER(ChebyshevPush, zero), MEMBER(ChebyshevPush, last),
             MEMBER(ChebyshevPush, reduce), MEMBER(ChebyshevPush, keep), MEMBER(ChebyshevPush, add)});
  }
  for (const vk::Spirv code : {vk::Spirv(coarse_solve_comp), vk::Spirv(coarse_solve_sp3_comp)}) {
    compare(code, "CoarseSolvePush",
            {MEMBER(CoarseSolvePush, rows), MEMBER(CoarseSolvePush, f), MEMBER(CoarseSolvePush, z),
             MEMBER(CoarseSolvePush, other), MEMBER(CoarseSolvePush, d), MEMBER(CoarseSolvePush, damping),
             MEMBER(CoarseSolvePush, state), MEMBER(CoarseSolvePush, count), MEMBER(CoarseSolvePush, steps),
             MEMBER(CoarseSolvePush, reduce), MEMBER(CoarseSolvePush, ratio)});
  }
  for (const vk::Spirv code : {vk::Spirv(restrict_comp), vk::Spirv(restrict_sp3_comp)}) {
    compare(code, "RestrictPush",
            {MEMBER(RestrictPush, offset), MEMBER(RestrictPush, place), MEMBER(RestrictPush, weight),
             MEMBER(RestrictPush, r), MEMBER(RestrictPush, f), MEMBER(RestrictPush, count)});
  }
  for (const vk::Spirv code : {vk::Spirv(prolong_comp), vk::Spirv(prolong_sp3_comp)}) {
    compare(code, "ProlongPush",
            {MEMBER(ProlongPush, index), MEMBER(ProlongPush, weight), MEMBER(ProlongPush, coarse_x),
             MEMBER(ProlongPush, x), MEMBER(ProlongPush, width), MEMBER(ProlongPush, count)});
  }
  for (const vk::Spirv code : {vk::Spirv(surface_change_comp), vk::Spirv(surface_change_sp3_comp)}) {
    compare(code, "SurfaceChangePush",
            {MEMBER(SurfaceChangePush, x),           MEMBER(SurfaceChangePush, to_phi),
             MEMBER(SurfaceChangePush, share),       MEMBER(SurfaceChangePush, before),
             MEMBER(SurfaceChangePush, scale),       MEMBER(SurfaceChangePush, state),
             MEMBER(SurfaceChangePush, reduction),   MEMBER(SurfaceChangePush, first),
             MEMBER(SurfaceChangePush, count),       MEMBER(SurfaceChangePush, what),
             MEMBER(SurfaceChangePush, level),       MEMBER(SurfaceChangePush, verify),
             MEMBER(SurfaceChangePush, stall_limit), MEMBER(SurfaceChangePush, max_iterations),
             MEMBER(SurfaceChangePush, looks),       MEMBER(SurfaceChangePush, by_change),
             MEMBER(SurfaceChangePush, least_rate),  MEMBER(SurfaceChangePush, slow_rate),
             MEMBER(SurfaceChangePush, by_residual), MEMBER(SurfaceChangePush, tolerance),
             MEMBER(SurfaceChangePush, boundary)});
  }
}
