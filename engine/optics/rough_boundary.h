// What a rough surface reflects (docs/physics.md, "Rough surfaces").
#pragma once

#include "engine/optics/optical_surface.h"

namespace quadgraph {

// Share of even light from outside that a surface of GGX roughness `alpha`, 0 to 1, reflects towards a view at outside
// cosine `cosine`, 0 to 1. That of a smooth one where alpha is 0; to 2e-3. Under a coat it is what comes back from the
// upper side of the coat, by its own roughness, and from below it, where facets look steeper by its index.
double rough_reflectance(double cosine, double alpha, const OpticalSurface& surface);

// Of that what comes back from the upper side of the coat.
double coat_reflectance(double cosine, const OpticalSurface& surface);

}  // namespace quadgraph
