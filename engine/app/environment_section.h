// The panel's section of the surroundings that light the body.
#pragma once

#include <string>

#include "engine/app/state.h"

namespace quadgraph {

// Puts an environment of that picture's file, or the name of the studio, in the place of the one that is there, or
// beside the other lights, as bright as the first of them. `bounds`: of the body.
void put_environment(Scene& scene, const std::string& file, const Sphere& bounds);

void draw_environment(State& state, const Sphere& bounds);

}  // namespace quadgraph
