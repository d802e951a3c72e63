// Of several bodies in a file the one whose material is changed: State::body.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/app/state.h"

namespace quadgraph {

// The text of its material, or of that of all.
const std::string& chosen_material(const State& state);

// Makes it of a material; or all, which then have none of their own.
void choose_material(State& state, const std::string& text);

// What a click on a body of that number does, or one beside all: of several bodies the one is chosen, or all, and said.
void choose_body(State& state, std::optional<std::uint32_t> number);

// The bodies of the file that is shown now; outermost: the number of the one around each, as of QuadGraph.
void take_bodies(State& state, const std::vector<std::string>& bodies, const std::vector<std::uint32_t>& outermost);

// The outermost body around the chosen one, with which it moves; empty where it moves by itself.
std::string moves_with(const State& state);

}  // namespace quadgraph
