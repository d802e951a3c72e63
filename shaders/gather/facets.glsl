// Facets of a rough surface that a view ray meets, drawn by chance.
#ifndef QUADGRAPH_FACETS_GLSL
#define QUADGRAPH_FACETS_GLSL

#include "shared/random.h"

struct Facets {
  float alpha;  // of GGX; 0: a smooth surface, nothing is drawn
  uint start;   // of the sequence of numbers, by pixel
  uint number;  // in the sequence
  uint drawn;   // so far
  // What the surface that a view ray starts at lets out; below 0: what its facets do not send back.
  float lets_out;
};

const Facets SMOOTH = Facets(0.0, 0u, 0u, 0u, -1.0);

bool is_rough(Facets facets) {
  return facets.alpha > 0.0;
}

// Two numbers in [0, 1) for the next facet, spread among all that are drawn there.
vec2 spread_facet(inout Facets facets) {
  uint start = facets.start + facets.drawn;
  facets.drawn += 2u;
  return vec2(spread_number(start, facets.number, 0u), spread_number(start, facets.number, 1u));
}

// Where random numbers for it begin.
uint random_state(Facets facets) {
  return hash(facets.start + hash((facets.number << 8u) + facets.drawn));
}

#endif
