// What sweeps see of the light that leaves a dense body, by the same code on the GPU and in the estimate of the error.
#ifndef QUADGRAPH_ELEMENT_LOSS_H
#define QUADGRAPH_ELEMENT_LOSS_H

#include "material/optics.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
using glm::exp;
using glm::pow;
using glm::sqrt;
#endif

// Rate at which light falls deep inside an even body, 1/mm: the root k of albedo atanh(k) = k of isotropic scattering,
// in mean free paths [Case 1967], within .6% at every albedo.
QG_INLINE vec3 decay_rate(Optical o) {
  vec3 lost = max(vec3(1.0f) - o.sigma_s_prime / sigma_t(o), vec3(0));
  vec3 squared = lost * (vec3(3.0f) - 0.155f * lost) / (vec3(1.0f) + 0.598f * lost + 1.247f * lost * lost);
  return sqrt(squared) * sigma_t(o);
}

// The share of the exitance that sweeps find where the element at the surface is `depth` mm deep: fluence and light
// scattered for the first time are linear in a tet, and so lie too deep. 1 up to LOSS_FROM decay lengths. Fitted to
// random walks on four bodies (docs/physics.md, "Transport correction").
const float LOSS_FROM = 1.3f;
QG_INLINE vec3 seen_of_element(Optical o, float depth, float eta) {
  vec3 rate = max(decay_rate(o), vec3(1e-12f)), of_mean_free_path = rate / sigma_t(o);
  vec3 beyond = max(rate * depth - LOSS_FROM, vec3(0)), share = beyond / (beyond + 15.2f);
  vec3 index = exp(2.75f * (1.4f - eta) * (of_mean_free_path - 0.7f));
  return vec3(1.0f) / (vec3(1.0f) + 3.76f * pow(of_mean_free_path, vec3(-0.4f)) * index * share * share);
}

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
