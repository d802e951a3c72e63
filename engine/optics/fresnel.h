// Fresnel quantities of a surface as if it were smooth, bare or under a coat. A number in place of an OpticalSurface is
// the index of refraction of a bare one, inside / outside.
#pragma once

#include "engine/optics/optical_surface.h"

namespace quadgraph {

inline constexpr double min_eta = 1.0;
inline constexpr double max_eta = 3.0;

// Unpolarised transmittance from outside at incidence cosine `cos_i` in [0, 1].
double fresnel_transmittance(double cos_i, const OpticalSurface& surface);

// Unpolarised reflectance from inside at the inside cosine `mu` in [0, 1]; 1 under total reflection.
double internal_reflectance(double mu, const OpticalSurface& surface);

// Internal diffuse reflectance by the published polynomial: -1.440/eta^2 + 0.710/eta + 0.668 + 0.0636 eta for eta > 1,
// 0 for eta = 1 [QG, PG; Groenhuis et al. 1983].
double internal_diffuse_reflectance(double eta);

// Published boundary mismatch A = (1 + F_dr) / (1 - F_dr).
double mismatch(double eta);

}  // namespace quadgraph
