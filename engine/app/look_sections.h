// The sections of the panel that both modes have, beside material, lights, paint and cuts.
#pragma once

#include "engine/app/state.h"

namespace quadgraph {

void draw_file(State& state);
void draw_shape(State& state, const Measured& measured);
void draw_film_choice(State& state);
void draw_camera(State& state, const Sphere& bounds);
void draw_picture(State& state, const Measured& measured);

}  // namespace quadgraph
