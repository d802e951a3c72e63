// Records the passes that fill an operator with values.
#pragma once

#include "engine/solve/level_buffers.h"
#include "engine/solve/operator_buffers.h"
#include "engine/solve/refractions.h"
#include "engine/solve/workspace.h"

namespace quadgraph {

// EditArrays on the device.
struct EditBuffers {
  std::uint32_t count = 0;
  device::Buffer edits, points, texels;
};

// The coefficients of the first `count` nodes; a material that varies is evaluated at level.rest, one of layers at
// `depth`.
void record_material(Workspace& work, const LevelBuffers& level, const gpu::Material& material,
                     const device::Buffer* depth, std::uint32_t count);

// The first `count` coefficients of `base`, which may be level.optical, with edits into level.optical; nodes
// are `spacing` apart, mm.
void record_edits(Workspace& work, const LevelBuffers& level, const device::Buffer& base, const EditBuffers& edits,
                  const device::Buffer* depth, float spacing, std::uint32_t count);

// `even`: level.optical is the same everywhere, which takes less time.
void record_assembly(Workspace& work, const LevelBuffers& level, Method method, const BodyBoundaries& boundaries,
                     bool even, OperatorBuffers& op);

// What keeps the steps of a solver from growing: record_damping or record_majorant.
enum class StepBound { none, damping, majorant };

// record_assembly, unless op has rows of these coefficients and boundaries, and what `bound` asks for.
void record_rows(Workspace& work, const LevelBuffers& level, Method method, const BodyBoundaries& boundaries, bool even,
                 StepBound bound, OperatorBuffers& op);

// The scale of the whole solve, from q of the finest level.
void record_scale(Workspace& work, const LevelBuffers& finest);

// b of the diffuse source, and its norm.
void record_diffuse_load(Workspace& work, const LevelBuffers& level, Method method, const BodyBoundaries& boundaries,
                         OperatorBuffers& op);

// b of fem where light is scattered at the surface itself, and its norm. q: address of what is, W/mm^2, vec3 per face.
void record_surface_load(Workspace& work, const LevelBuffers& level, std::uint64_t q, OperatorBuffers& op);

// The step of the relaxation: 1 for the graph methods, as published; for fem the largest that cannot diverge.
void record_damping(Workspace& work, Method method, OperatorBuffers& op);

// The blocks that the smoother of cycles divides by (MajorantPush); fem only.
void record_majorant(Workspace& work, OperatorBuffers& op);

}  // namespace quadgraph
