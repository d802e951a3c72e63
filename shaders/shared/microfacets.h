// A rough surface as facets that are smooth each: the GGX distribution with Smith's masking (Walter et al. 2007), by
// the same code on the GPU and in C++. Ways and facets are unit vectors in the frame whose third axis is the normal of
// the surface.
#ifndef QUADGRAPH_MICROFACETS_H
#define QUADGRAPH_MICROFACETS_H

#include "shared/shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
using glm::abs;
using glm::max;
using glm::min;
using glm::normalize;
using glm::pow;
#endif

// Of a view with a rough surface: at least that.
const float LEAST_SEEN_COSINE = 1e-3f;

// Smith's Lambda of a way at that cosine, above 0: of facets turned towards it 1 / (1 + Lambda) are not hidden.
QG_INLINE float smith_lambda(float cosine, float alpha) {
  float squared = cosine * cosine;
  return 0.5f * (sqrt(1.0f + alpha * alpha * max(1.0f - squared, 0.0f) / squared) - 1.0f);
}

// A facet that is seen along `way`, as often as it is seen; u: two numbers in [0, 1) (Dupuy and Benyoub 2023).
QG_INLINE vec3 visible_facet(vec3 way, float alpha, vec2 u) {
  vec3 stretched = normalize(vec3(alpha * way.x, alpha * way.y, way.z));
  float turn = 6.2831853f * u.x, z = (1.0f - u.y) * (1.0f + stretched.z) - stretched.z;
  float sine = sqrt(max(1.0f - z * z, 0.0f));
  vec3 cap = vec3(sine * cos(turn), sine * sin(turn), z) + stretched;
  return normalize(vec3(alpha * cap.x, alpha * cap.y, max(cap.z, 1e-6f)));
}

// What follows is of a way over the facets of the surface (Heitz 2016), on the side where
// it is: 1 outside, -1 inside. Heights are shares of the facets that lie below.
const float CLEAR_OF_FACETS = 2.0f;
const float LEAST_BELOW = 1e-6f;
const float UPRIGHT = 0.9999f, LEVEL = 1e-4f;  // cosines at which Smith's Lambda has a limit

// Height of the next facet that a way at that cosine with the normal of its side meets, from one of height `below`, or
// CLEAR_OF_FACETS. u: a number in [0, 1).
QG_INLINE float next_facet(float below, float cosine, float alpha, float u) {
  float from = min(max(below, LEAST_BELOW), 1.0f - LEAST_BELOW), lean = abs(cosine);
  if (lean > UPRIGHT) return cosine > 0.0f ? CLEAR_OF_FACETS : u * from;
  if (lean < LEVEL) return from;
  float above = smith_lambda(lean, alpha);
  if (cosine < 0.0f) return from * pow(1.0f - u, 1.0f / (1.0f + above));
  if (u > 1.0f - pow(from, above)) return CLEAR_OF_FACETS;
  return min(from * pow(1.0f - u, -1.0f / above), 1.0f);
}

// A facet that a way on that side meets, turned to where it comes from; u as of visible_facet.
QG_INLINE vec3 met_facet(vec3 way, float side, float alpha, vec2 u) {
  return side * visible_facet(-side * way, alpha, u);
}

// The way through a facet at that cosine with it, by the index of refraction here over that across.
QG_INLINE vec3 way_through(vec3 way, vec3 facet, float cosine, float ratio) {
  float across = sqrt(max(1.0f - ratio * ratio * (1.0f - cosine * cosine), 0.0f));
  return normalize(ratio * way + (ratio * cosine - across) * facet);
}

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
