// Quantities derived from the coefficients of a point, by the same code on the GPU and in the CPU reference.
#ifndef QUADGRAPH_OPTICS_H
#define QUADGRAPH_OPTICS_H

#include "shared/shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
using glm::max;
using glm::min;
#endif

// Largest scattering or absorption, 1/mm: a mean free path of a nanometre. Edits take more as this.
const float COEFFICIENT_MAX = 1e6f;

// Floor of sigma_t in the operators, 1/mm. A clear region has no diffusion coefficient; with a mean free path of ten
// metres fluence is uniform across it, and single precision still carries the contrast to any measured material.
const float SIGMA_T_MIN = 1e-4f;

// Reduced extinction coefficient of the operators, 1/mm, > 0.
QG_INLINE vec3 sigma_t(Optical o) {
  return max(o.sigma_a + o.sigma_s_prime, vec3(SIGMA_T_MIN));
}

// Diffusion coefficient, mm.
QG_INLINE vec3 kappa(Optical o) {
  return vec3(1.0f / 3.0f) / sigma_t(o);
}

// Largest entry of linear elements of size `spacing` (mm) of any channel over that of another: stiffness and mass.
QG_INLINE float entry_contrast(Optical o, float spacing) {
  vec3 size = kappa(o) + (spacing * spacing / 20.0f) * o.sigma_a;
  return max(size.x, max(size.y, size.z)) / min(size.x, min(size.y, size.z));
}

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
