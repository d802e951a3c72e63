// Light at a rough surface as it goes from facet to facet. All that one mirrors or lets through is followed until it is
// clear of the surface, on either side: nothing is lost, and nothing has to be known of the surface as a whole.
#ifndef QUADGRAPH_FACET_WALK_GLSL
#define QUADGRAPH_FACET_WALK_GLSL

#include "material/facet_frame.glsl"
#include "material/fresnel.glsl"
#include "shared/random.glsl"

const uint FACET_MEETINGS = 200u;  // after which a way stays on the side where it is

vec2 two_numbers(inout uint state) {
  float u = uniform_number(state), v = uniform_number(state);
  return vec2(u, v);
}

// Turns light that meets the surface of outward normal n, from inside or outside, into what goes on; whether that has
// gone through. u: two numbers in [0, 1), by which the first facet is drawn.
bool goes_through_facets(bool inside, vec3 n, OpticalSurface surface, vec2 u, inout vec3 direction, inout uint state) {
  FacetFrame frame = facet_frame(n);
  vec3 way = vec3(dot(direction, frame.across), dot(direction, frame.up), dot(direction, n));
  float below = 1.0, begins = inside ? -1.0 : 1.0, side = begins;
  for (uint k = 0u; k < FACET_MEETINGS; ++k) {
    below = next_facet(below, side * way.z, surface.roughness, uniform_number(state));
    if (below == CLEAR_OF_FACETS) break;
    vec3 facet = met_facet(way, side, surface.roughness, u);
    float cosine = clamp(-dot(way, facet), 0.0, 1.0);
    float mirrored = side > 0.0 ? fresnel_reflectance(cosine, surface) : internal_reflectance(cosine, surface);
    if (uniform_number(state) < mirrored) {
      way = normalize(way + 2.0 * cosine * facet);
    } else {
      way = way_through(way, facet, cosine, side > 0.0 ? 1.0 / surface.eta : surface.eta);
      side = -side;
      below = 1.0 - below;
    }
    u = two_numbers(state);
  }
  direction = normalize(out_of_frame(frame, way));
  return side != begins;
}

#endif
