// The panel's list of layers of strokes, in its section Paint.
#pragma once

#include "engine/app/state.h"

namespace quadgraph {

void draw_layers(State& state);

}  // namespace quadgraph
