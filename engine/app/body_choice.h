// Of several bodies in a file the one whose material is changed: State::body.
#pragma once

#include <string>

#include "engine/app/state.h"

namespace quadgraph {

// The text of its material, or of that of all.
const std::string& chosen_material(const State& state);

// Makes it of a material; or all, which then have none of their own.
void choose_material(State& state, const std::string& text);

// The text of a named material for it, at the index of refraction of the bodies that stay as they are: those of one
// file have one.
std::string at_index_of_others(const State& state, const std::string& name);

// The bodies of the file that is shown now.
void take_bodies(State& state, const std::vector<std::string>& bodies);

}  // namespace quadgraph
