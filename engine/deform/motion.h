// How frames in motion are solved.
#pragma once

#include <span>

#include "engine/base/solve_options.h"

namespace quadgraph {

struct Level;

// Options for a frame in motion: one cycle and one bounce from the last solution (twenty steps of conjugate gradients
// or sweeps where the method has no cycles), uniform light by one ray per origin, and visibility traced again for an
// eighth of the faces. The method shortest-path stays as it is.
SolveOptions in_motion(SolveOptions options, std::span<const Level> levels);

}  // namespace quadgraph
