// Facets of a rough surface that a view ray meets, drawn by chance.
#ifndef QUADGRAPH_FACETS_GLSL
#define QUADGRAPH_FACETS_GLSL

#include "shared/microfacets.h"
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
  // Not frame_about, which leaps where n.z is 0: there lie sides of boxes, and rounding would choose their facets.
  vec3 across = normalize(cross(abs(n.x) < 0.5 ? vec3(1, 0, 0) : vec3(0, 1, 0), n)), up = cross(n, across);
  towards = normalize(vec3(dot(outward, across), dot(outward, up), max(dot(outward, n), LEAST_SEEN_COSINE)));
  local = visible_facet(towards, facets.alpha, u);
  return local.x * across + local.y * up + local.z * n;
}

#endif
