// Of several bodies in a file the one whose material is changed: State::body.
#pragma once

#include <string>

#include "engine/app/state.h"

namespace quadgraph {

// The text of its material, or of that of all.
const std::string& chosen_material(const State& state);

// Makes it of a material; or all, which then have none of their own.
void choose_material(State& state, const std::string& text);

// The bodies of the file that is shown now.
void take_bodies(State& state, const std::vector<std::string>& bodies);

}  // namespace quadgraph
