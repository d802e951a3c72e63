// Modes that a key or a button enters and that Esc leaves: the brush, the knife, the shortcuts.
#pragma once

#include "engine/app/state.h"

namespace quadgraph {

void take_brush(State& state, bool on);
void take_knife(State& state, bool on);

// Leaves the mode that was entered last; whether there was one.
bool leave_mode(State& state);

// Cuts are shown by shortest paths alone, which have no views of the inside: as long as there are some, or the knife is
// on, that method is taken; after that the one that was there before, with its view.
void keep_method(State& state);

}  // namespace quadgraph
