// The sections of the panel that only the mode Lab has: how the picture is computed, what that took, and what is
// inside.
#pragma once

#include "engine/app/state.h"

namespace quadgraph {

void draw_frame(const Measured& measured);
void draw_show(State& state, const Engine& engine);
void draw_solver(State& state);
void draw_passes(const std::vector<PassStats>& passes);

}  // namespace quadgraph
