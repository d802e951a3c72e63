// The panel's section of the material: swatches of those that have a name, colour, how far light goes, roughness, text.
#pragma once

#include "engine/app/state.h"

namespace quadgraph {

// `unit`: window coordinates per pixel of an ordinary display.
void draw_material(State& state, float unit);

}  // namespace quadgraph
