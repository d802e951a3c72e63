// A rough surface as facets that are smooth each: the GGX distribution with Smith's masking (Walter et al. 2007), by
// the same code on the GPU and in C++. Ways and facets are unit vectors in the frame whose third axis is the normal of
// the surface.
#ifndef QUADGRAPH_MICROFACETS_H
#define QUADGRAPH_MICROFACETS_H

#include "shared/shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
using glm::max;
using glm::min;
using glm::normalize;
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

// Share of what a facet reflects along `way` that no other facet holds up on either side of it (height-correlated,
// Heitz 2014). What is held up goes in after all: what is mirrored and what comes through are all of the light.
QG_INLINE float gone_for_good(vec3 way, vec3 facet, float alpha) {
  float cosine = 2.0f * dot(way, facet) * facet.z - way.z;  // of what is mirrored
  if (cosine <= 0.0f) return 0.0f;
  float seen = 1.0f + smith_lambda(way.z, alpha);
  return seen / (seen + smith_lambda(min(cosine, 1.0f), alpha));
}

// Share of light at that cosine with the normal of the surface that no facet holds up on its way from it (Heitz 2014).
QG_INLINE float free_of_facets(float cosine, float alpha) {
  return cosine > 0.0f ? 1.0f / (1.0f + smith_lambda(min(cosine, 1.0f), alpha)) : 0.0f;
}

// Cosine with the normal, on the other side of the surface, of light from `way` that a facet refracts into an index of
// refraction eta times as high; below 0: another facet has it.
QG_INLINE float refracted_cosine(vec3 way, vec3 facet, float eta) {
  float seen = min(max(dot(way, facet), 0.0f), 1.0f);
  float bent = sqrt(max(1.0f - (1.0f - seen * seen) / (eta * eta), 0.0f));
  return (way.z - (seen - eta * bent) * facet.z) / eta;
}

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
