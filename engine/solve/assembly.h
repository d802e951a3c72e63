// Records the passes that fill an operator with values.
#pragma once

#include "engine/solve/operator_buffers.h"
#include "engine/solve/simulation.h"
#include "engine/solve/workspace.h"

namespace quadgraph {

void record_material(Workspace& work, const LevelBuffers& level, const gpu::Material& material);

void record_assembly(Workspace& work, const LevelBuffers& level, Method method, double eta, OperatorBuffers& op);

// The scale of the whole solve, from q of the finest level.
void record_scale(Workspace& work, const LevelBuffers& finest);

void record_right_hand_side(Workspace& work, const LevelBuffers& level, Method method, double eta, OperatorBuffers& op);

// The step of the relaxation: 1 for the graph methods, as published; for fem the largest that cannot diverge.
void record_damping(Workspace& work, Method method, OperatorBuffers& op);

}  // namespace quadgraph
