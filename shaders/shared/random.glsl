#ifndef QUADGRAPH_RANDOM_GLSL
#define QUADGRAPH_RANDOM_GLSL

#include "shared/random.h"

// Uniform in [0, 1), and the next state.
float uniform_number(inout uint state) {
  state = state * 747796405u + 2891336453u;
  return float(hash(state) >> 8u) * exp2(-24.0);
}

#endif
