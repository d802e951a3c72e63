// The panel's section of cuts: which there are, and where the selected one is.
#pragma once

#include "engine/app/state.h"

namespace quadgraph {

void draw_cuts(State& state, const Sphere& bounds);

}  // namespace quadgraph
