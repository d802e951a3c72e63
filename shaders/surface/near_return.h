// Light that comes out near where it went in, by the same code on the GPU and in the CPU reference.
#ifndef QUADGRAPH_NEAR_RETURN_H
#define QUADGRAPH_NEAR_RETURN_H

#include "material/optics.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
using glm::clamp;
using glm::sqrt;
#endif

// Where edges are EVEN_LONG mean free paths or longer the exitance is made even (even_exitance.comp); nothing where
// they are half as long.
const float EVEN_LONG = 4.0f;
// Of what a half-space returns, what counts as coming out within about such an edge.
const float NEAR_SHARE = 0.85f;

// Of light that has entered a half-space what comes out near by: isotropic scattering (Hulst 1980), of which the share
// `kept` is reflected back in at the surface.
QG_INLINE vec3 near_return(Optical o, float kept) {
  vec3 s = sqrt(clamp(o.sigma_a / sigma_t(o), vec3(0), vec3(1)));
  vec3 reaches = (vec3(1.0f) - s) * (vec3(1.0f) - 0.139f * s) / (vec3(1.0f) + 1.17f * s);
  return NEAR_SHARE * (1.0f - kept) * reaches / (vec3(1.0f) - kept * reaches);
}

// How far the exitance is made even, of edges of that length, mm.
QG_INLINE vec3 evened_share(Optical o, float edge) {
  return clamp((2.0f / EVEN_LONG) * edge * sigma_t(o) - vec3(1.0f), vec3(0), vec3(1));
}

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
