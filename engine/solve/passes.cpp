#include "engine/solve/passes.h"

#include "shaders/walk_shared.h"
#include "spirv/assemble_fdm.comp.h"
#include "spirv/assemble_fem.comp.h"
#include "spirv/assemble_fv.comp.h"
#include "spirv/cg_direction.comp.h"
#include "spirv/cg_multiply.comp.h"
#include "spirv/cg_start.comp.h"
#include "spirv/cg_update.comp.h"
#include "spirv/damping.comp.h"
#include "spirv/energy.comp.h"
#include "spirv/evaluate_material.comp.h"
#include "spirv/exitance.comp.h"
#include "spirv/irradiance_scale.comp.h"
#include "spirv/right_hand_side_buried.comp.h"
#include "spirv/right_hand_side_fdm.comp.h"
#include "spirv/right_hand_side_fem.comp.h"
#include "spirv/right_hand_side_fv.comp.h"
#include "spirv/sweep.comp.h"
#include "spirv/transfer.comp.h"
#include "spirv/vertex_exitance.comp.h"
#include "spirv/vertex_unscattered.comp.h"
#include "spirv/walk_source.comp.h"

namespace quadgraph {

Passes::Passes()
    : evaluate_material(evaluate_material_comp, sizeof(gpu::EvaluateMaterialPush), "evaluate material"),
      assemble_fdm(assemble_fdm_comp, sizeof(gpu::AssembleFdmPush), "assemble fdm"),
      assemble_fv(assemble_fv_comp, sizeof(gpu::AssembleFvPush), "assemble fv"),
      assemble_fem(assemble_fem_comp, sizeof(gpu::AssembleFemPush), "assemble fem"),
      irradiance_scale(irradiance_scale_comp, sizeof(gpu::IrradianceScalePush), "irradiance scale"),
      right_hand_side_fdm(right_hand_side_fdm_comp, sizeof(gpu::RightHandSideFdmPush), "right hand side fdm"),
      right_hand_side_fv(right_hand_side_fv_comp, sizeof(gpu::RightHandSideFvPush), "right hand side fv"),
      right_hand_side_fem(right_hand_side_fem_comp, sizeof(gpu::RightHandSideFemPush), "right hand side fem"),
      right_hand_side_buried(right_hand_side_buried_comp, sizeof(gpu::RightHandSideBuriedPush),
                             "right hand side buried"),
      walk_source(walk_source_comp, sizeof(gpu::WalkSourcePush), "walk source"),
      vertex_unscattered(vertex_unscattered_comp, sizeof(gpu::VertexUnscatteredPush), "vertex unscattered"),
      damping(damping_comp, sizeof(gpu::DampingPush), "damping"),
      transfer(transfer_comp, sizeof(gpu::TransferPush), "transfer"),
      cg_start(cg_start_comp, sizeof(gpu::CgStartPush), "cg start"),
      cg_multiply(cg_multiply_comp, sizeof(gpu::CgMultiplyPush), "cg multiply"),
      cg_update(cg_update_comp, sizeof(gpu::CgUpdatePush), "cg update"),
      cg_direction(cg_direction_comp, sizeof(gpu::CgDirectionPush), "cg direction"),
      sweep(sweep_comp, sizeof(gpu::SweepPush), "sweep"),
      exitance(exitance_comp, sizeof(gpu::ExitancePush), "exitance"),
      vertex_exitance(vertex_exitance_comp, sizeof(gpu::VertexExitancePush), "vertex exitance"),
      energy(energy_comp, sizeof(gpu::EnergyPush), "energy") {}

}  // namespace quadgraph
