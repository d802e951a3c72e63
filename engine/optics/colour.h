// From the colour that a material shows to its albedo: the inverse of the half-space's reflectance.
#pragma once

namespace quadgraph {

// Exitance of a half-space over the irradiance that arrives at normal incidence, surface reflection apart: what is left
// of it at the surface times M / q of SP3. albedo sigma_s' / sigma_t in [0, 1], eta in [1, 3].
double diffuse_reflectance(double albedo, double eta);

// The albedo that has that reflectance, which is at least 0 and less than that of albedo 1.
double albedo_of(double reflectance, double eta);

}  // namespace quadgraph
