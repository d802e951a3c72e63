// What every carrier on the surface stands for in an error of the exitance.
#pragma once

#include "engine/solve/level_buffers.h"
#include "engine/solve/operator_buffers.h"
#include "engine/solve/refractions.h"
#include "engine/solve/workspace.h"

namespace quadgraph {

// Fills op.surface_share for the present q; the scale is in place.
void record_surface_share(Workspace& work, const LevelBuffers& level, Method method, const BodyBoundaries& boundaries,
                          const OperatorBuffers& op);

// What of the SurfaceShares of so many carriers is of the dimmest third, where these have the exitance m
// (vec3, in any unit).
void record_surface_dimmest(Workspace& work, const device::Buffer& m, const device::Buffer& share, std::uint32_t count);

}  // namespace quadgraph
