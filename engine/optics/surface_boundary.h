// What a surface as a whole mirrors, smooth or rough: what solves know of it. A number in place of an OpticalSurface is
// the index of refraction of a bare and smooth one, inside / outside.
#pragma once

#include <array>

#include "engine/optics/optical_surface.h"

namespace quadgraph {

// Of a rough surface as passes read it (gpu::OpticalSurface::boundary), linear between these places: by ways from facet
// to facet (docs/physics.md, "Rough surfaces"), but that a coat mirrors from outside as rough_reflectance has it. What
// stays inside is such that in even light as much goes in as out.
using RoughBoundary = std::array<float, gpu::BOUNDARY_VALUES>;
RoughBoundary rough_boundary(const OpticalSurface& surface);

// GGX alpha of the facets that turn what goes in and out (gpu::facet_roughness).
float facet_roughness(const OpticalSurface& surface);

// Share of light from outside at that cosine, in [0, 1], that goes in.
double surface_transmittance(double cosine, const OpticalSurface& surface);

// R_n, the integral of what the surface mirrors of light from inside times mu^n over its cosine mu there from 0 to 1;
// to 1e-10 of a smooth one.
double fresnel_moment(int n, const OpticalSurface& surface);

// Share of uniform light from outside that enters, the integral of 2 mu surface_transmittance over the outside cosine:
// by reciprocity eta^2 (1 - 2 R_1).
double diffuse_transmittance(const OpticalSurface& surface);

// Integral of surface_transmittance cos over the hemisphere, sr: what exitance is divided by to give radiance along it,
// so that it integrates back to the exitance (docs/physics.md, "Gathered radiance"). pi for eta = 1.
double radiance_norm(const OpticalSurface& surface);

}  // namespace quadgraph
