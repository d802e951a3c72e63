// The panel's section of edits: what the brush does.
#pragma once

#include "engine/app/state.h"

namespace quadgraph {

void draw_edits(State& state, const Sphere& bounds);

}  // namespace quadgraph
