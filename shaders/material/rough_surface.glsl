// Directions of light that goes in and out by the facets of a surface, drawn by chance as often as they take it.
#ifndef QUADGRAPH_ROUGH_SURFACE_GLSL
#define QUADGRAPH_ROUGH_SURFACE_GLSL

#include "material/facet_frame.glsl"
#include "material/fresnel.glsl"
#include "shared/random.glsl"

// Facets that are tried before the surface is taken as smooth.
const uint FACET_TRIES = 8u;

// One that is seen along `towards`; both in the frame of the surface.
vec3 drawn_facet(vec3 towards, float alpha, inout uint state) {
  float u = uniform_number(state), v = uniform_number(state);
  return visible_facet(towards, alpha, vec2(u, v));
}

// Normal of the facet by which light goes in that travels along `incoming` outside and does go in.
vec3 facet_that_lets_in(vec3 incoming, vec3 n, OpticalSurface surface, inout uint state) {
  if (surface.roughness == 0.0) return n;
  FacetFrame frame = facet_frame(n);
  vec3 towards = into_frame(frame, -incoming);
  for (uint k = 0u; k < FACET_TRIES; ++k) {
    vec3 facet = drawn_facet(towards, surface.roughness, state);
    float seen = clamp(dot(towards, facet), 0.0, 1.0);
    float mirrored = fresnel_reflectance(seen, surface) * gone_for_good(towards, facet, surface.roughness);
    float goes_in = uniform_number(state), is_clear = uniform_number(state);
    float down = refracted_cosine(towards, facet, surface.eta);
    if (goes_in >= mirrored && is_clear < free_of_facets(down, surface.roughness)) return out_of_frame(frame, facet);
  }
  return n;
}

// Outside, for a direction that leaves at inside cosine `cosine` by a smooth surface or facet.
vec3 leaving_direction(vec3 direction, vec3 n, float cosine, float eta) {
  float outside = sqrt(max(1.0 - eta * eta * (1.0 - cosine * cosine), 0.0));
  return normalize(eta * (direction - cosine * n) + outside * n);
}

// The way on, out or mirrored, of light that meets the surface from inside along `direction`.
vec3 way_on(vec3 direction, vec3 n, OpticalSurface surface, bool goes_out, inout uint state) {
  float cosine = clamp(dot(direction, n), 0.0, 1.0);
  if (surface.roughness > 0.0) {
    FacetFrame frame = facet_frame(n);
    vec3 towards = into_frame(frame, direction);
    for (uint k = 0u; k < FACET_TRIES; ++k) {
      vec3 facet = out_of_frame(frame, drawn_facet(towards, surface.roughness, state));
      float seen = clamp(dot(direction, facet), 0.0, 1.0);
      bool mirrored = uniform_number(state) < internal_reflectance(seen, surface);
      if (mirrored == goes_out) continue;
      vec3 way = goes_out ? leaving_direction(direction, facet, seen, surface.eta)
                          : normalize(direction - 2.0 * seen * facet);
      float away = goes_out ? dot(way, n) : -dot(way, n);
      if (uniform_number(state) < free_of_facets(away, surface.roughness)) return way;
    }
  }
  return goes_out ? leaving_direction(direction, n, cosine, surface.eta) : normalize(direction - 2.0 * cosine * n);
}

#endif
