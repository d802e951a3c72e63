#ifndef QUADGRAPH_FRESNEL_GLSL
#define QUADGRAPH_FRESNEL_GLSL

#include "shared/optical_surface.h"

// Unpolarised reflectance of a smooth boundary from outside at incidence cosine `cos_i` in [0, 1]; eta = inside over
// outside >= 1. Exact, as engine/optics/fresnel.h.
float fresnel_reflectance(float cos_i, float eta) {
  if (eta == 1.0) return 0.0;
  float cos_t = sqrt(max(0.0, 1.0 - (1.0 - cos_i * cos_i) / (eta * eta)));
  // Both over one denominator: a division is slow.
  float parallel = eta * cos_i + cos_t, perpendicular = cos_i + eta * cos_t;
  float a = (eta * cos_i - cos_t) * perpendicular, b = (cos_i - eta * cos_t) * parallel, c = parallel * perpendicular;
  return 0.5 * (a * a + b * b) / (c * c);
}

// From inside at cosine `cosine`: 1 under total reflection.
float internal_reflectance(float cosine, float eta) {
  float sin_o_squared = eta * eta * (1.0 - cosine * cosine);
  return sin_o_squared >= 1.0 ? 1.0 : fresnel_reflectance(sqrt(1.0 - max(sin_o_squared, 0.0)), eta);
}

// Reflectances of both polarisations where light goes from an index of refraction into another, by the cosines there.
vec2 polarised_reflectances(float from, float cos_from, float into, float cos_into) {
  float parallel = (into * cos_from - from * cos_into) / max(into * cos_from + from * cos_into, 1e-20);
  float across = (from * cos_from - into * cos_into) / max(from * cos_from + into * cos_into, 1e-20);
  return vec2(parallel * parallel, across * across);
}

// Of a body under a coat, from outside, with all that goes to and fro in the coat.
float coated_reflectance(float cos_i, OpticalSurface surface) {
  float sine2 = 1.0 - cos_i * cos_i;
  float cos_coat = sqrt(max(0.0, 1.0 - sine2 / (surface.coat_eta * surface.coat_eta)));
  float cos_body = sqrt(max(0.0, 1.0 - sine2 / (surface.eta * surface.eta)));
  vec2 above = polarised_reflectances(1.0, cos_i, surface.coat_eta, cos_coat);
  vec2 below = polarised_reflectances(surface.coat_eta, cos_coat, surface.eta, cos_body);
  vec2 through = (1.0 - above) * (1.0 - below) / max(1.0 - above * below, vec2(1e-20));
  return 1.0 - 0.5 * (through.x + through.y);
}

// Whether it mirrors anything.
bool reflects(OpticalSurface surface) {
  return surface.eta != 1.0 || surface.coat != 0.0;
}

// As a smooth surface is, or a facet of a rough one, coated in parts.
float fresnel_reflectance(float cos_i, OpticalSurface surface) {
  float bare = fresnel_reflectance(cos_i, surface.eta);
  return surface.coat == 0.0 ? bare : mix(bare, coated_reflectance(cos_i, surface), surface.coat);
}

float fresnel_transmittance(float cos_i, OpticalSurface surface) {
  return 1.0 - fresnel_reflectance(cos_i, surface);
}

// The same from inside: no coat lets out what the bare surface mirrors wholly.
float internal_reflectance(float cosine, OpticalSurface surface) {
  float sin_o_squared = surface.eta * surface.eta * (1.0 - cosine * cosine);
  return sin_o_squared >= 1.0 ? 1.0 : fresnel_reflectance(sqrt(1.0 - max(sin_o_squared, 0.0)), surface);
}

// Of a rough surface at `place`, from 0 to 1, of `steps` even ones that begin with number `first`.
float of_boundary(OpticalSurface surface, uint first, uint steps, float place) {
  float at = clamp(place, 0.0, 1.0) * float(steps);
  uint cell = min(uint(at), steps - 1u);
  Floats values = Floats(surface.boundary);
  return mix(values.at[first + cell], values.at[first + cell + 1u], at - float(cell));
}

// Share of light from outside at that cosine that goes in, by a smooth surface or by all facets of a rough one.
float surface_transmittance(float cosine, OpticalSurface surface) {
  if (surface.roughness == 0.0) return fresnel_transmittance(cosine, surface);
  return 1.0 - of_boundary(surface, 0u, OUTSIDE_STEPS, sqrt(max(cosine, 0.0)));
}

// Mean cosine inside of light from outside at that cosine.
float cosine_inside(float cosine, OpticalSurface surface) {
  if (surface.roughness > 0.0) return of_boundary(surface, BOUNDARY_COSINES, OUTSIDE_STEPS, sqrt(max(cosine, 0.0)));
  return sqrt(max(1.0 - (1.0 - cosine * cosine) / (surface.eta * surface.eta), 0.0));
}

// What of light from inside at that cosine stays inside.
float surface_reflectance_inside(float cosine, OpticalSurface surface) {
  if (surface.roughness == 0.0) return internal_reflectance(cosine, surface);
  return of_boundary(surface, BOUNDARY_INSIDE, INSIDE_STEPS, cosine);
}

#endif
