// Quantities derived from the coefficients of a point, by the same code on the GPU and in the CPU reference.
#ifndef QUADGRAPH_OPTICS_H
#define QUADGRAPH_OPTICS_H

#include "shared/shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
using glm::max;
using glm::min;
using glm::mix;
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

// From `a` towards `b` by a share of the way.
QG_INLINE Optical mixed(Optical a, Optical b, float share) {
  Optical between;
  between.sigma_s_prime = mix(a.sigma_s_prime, b.sigma_s_prime, share);
  between.sigma_a = mix(a.sigma_a, b.sigma_a, share);
  return between;
}

QG_INLINE float contrast(vec3 large, vec3 small) {
  return max(large.x, max(large.y, large.z)) / min(small.x, min(small.y, small.z));
}

// How much packed entries (solver/packing.h), in which three channels share an exponent, round the channel that loses
// most on elements of size `spacing` (mm), by the sizes of stiffness and mass: in shares of what changes its exitance
// by about 1e-3. x: diffusion, y: SP3, which packs the masses for themselves.
QG_INLINE vec2 packed_rounding(Optical o, float spacing) {
  vec3 mass = (spacing * spacing / 20.0f) * o.sigma_a, size = kappa(o) + mass, extinction = sigma_t(o);
  float entries = contrast(size, size) / 15.0f;
  return vec2(entries, max(entries, max(contrast(extinction, extinction) / 40.0f, contrast(mass, size) / 0.5f)));
}

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
