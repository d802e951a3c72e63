// The panel's section of lights: which there are, and what the selected one is like.
#pragma once

#include "engine/app/state.h"

namespace quadgraph {

void draw_lights(State& state, const Sphere& bounds);

}  // namespace quadgraph
