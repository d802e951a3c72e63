// Directions of light that goes in and out by the facets of a surface, drawn by chance as often as they take it.
#ifndef QUADGRAPH_ROUGH_SURFACE_GLSL
#define QUADGRAPH_ROUGH_SURFACE_GLSL

#include "material/facet_walk.glsl"

// Ways that are tried before the surface is taken as smooth.
const uint FACET_TRIES = 4u;

// The way on of light that meets a rough surface and goes through it, or does not, by its facets; false: none was found.
// u: as of goes_through_facets, of the first try.
bool way_by_facets(bool inside, bool through, vec3 n, OpticalSurface surface, vec2 u, inout vec3 direction, inout uint state) {
  for (uint k = 0u; k < FACET_TRIES; ++k) {
    vec3 way = direction;
    if (goes_through_facets(inside, n, surface, u, way, state) == through) {
      direction = way;
      return true;
    }
    u = two_numbers(state);
  }
  return false;
}

// Outside, for a direction that leaves at inside cosine `cosine` by a smooth surface or facet.
vec3 leaving_direction(vec3 direction, vec3 n, float cosine, float eta) {
  float outside = sqrt(max(1.0 - eta * eta * (1.0 - cosine * cosine), 0.0));
  return normalize(eta * (direction - cosine * n) + outside * n);
}

// The way on, out or mirrored, of light that meets the surface from inside along `direction`: where few ways end on that
// side, and none did, by one facet.
vec3 way_on(vec3 direction, vec3 n, OpticalSurface surface, bool goes_out, inout uint state) {
  vec3 facet = n;
  if (surface.roughness > 0.0) {
    if (way_by_facets(true, goes_out, n, surface, two_numbers(state), direction, state)) return direction;
    FacetFrame frame = facet_frame(n);
    facet = out_of_frame(frame, visible_facet(into_frame(frame, direction), surface.roughness, two_numbers(state)));
    vec3 mirrored = direction - 2.0 * dot(direction, facet) * facet;
    if (!goes_out && dot(mirrored, n) >= 0.0) facet = n;
  }
  float cosine = clamp(dot(direction, facet), 0.0, 1.0);
  return goes_out ? leaving_direction(direction, facet, cosine, surface.eta)
                  : normalize(direction - 2.0 * cosine * facet);
}

#endif
