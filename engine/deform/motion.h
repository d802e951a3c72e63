// How frames in motion are solved.
#pragma once

#include <span>

#include "engine/base/solve_options.h"

namespace quadgraph {

struct Level;

// The same with one cycle and one bounce from the last solution (twenty steps of conjugate gradients or sweeps where
// the method has no cycles), even light by one ray from an origin, and an eighth of the faces looking anew at what they
// see. The method shortest-path stays as it is.
SolveOptions in_motion(SolveOptions options, std::span<const Level> levels);

}  // namespace quadgraph
