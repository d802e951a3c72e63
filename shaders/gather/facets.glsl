// Facets of a rough surface that a view ray meets, drawn by chance.
#ifndef QUADGRAPH_FACETS_GLSL
#define QUADGRAPH_FACETS_GLSL

#include "material/facet_frame.glsl"
#include "shared/random.h"

struct Facets {
  float alpha;  // of GGX; 0: a smooth surface, nothing is drawn
  uint start;   // of the sequence of numbers, by pixel
  uint number;  // in the sequence
  uint drawn;   // so far
  // What the surface that a view ray starts at lets out, where facets say its directions alone; below 0: they say both.
  float lets_out;
};

const Facets SMOOTH = Facets(0.0, 0u, 0u, 0u, -1.0);

bool is_rough(Facets facets) {
  return facets.alpha > 0.0;
}

// The next facet of a surface of normal `n` that is seen along `outward`, which is turned out of the surface if it is
// not; towards: `outward` in the frame of the surface; local: the facet there.
vec3 facet_seen(inout Facets facets, vec3 n, vec3 outward, out vec3 towards, out vec3 local) {
  vec2 u = vec2(spread_number(facets.start + facets.drawn, facets.number, 0u),
                spread_number(facets.start + facets.drawn, facets.number, 1u));
  facets.drawn += 2u;
  FacetFrame frame = facet_frame(n);
  towards = into_frame(frame, outward);
  local = visible_facet(towards, facets.alpha, u);
  return out_of_frame(frame, local);
}

#endif
