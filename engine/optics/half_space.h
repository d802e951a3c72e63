// What a half-space sends back of light at normal incidence, from closed forms: exactly, and on linear elements.
#pragma once

#include "engine/base/solve_options.h"
#include "engine/optics/boundary.h"

namespace quadgraph {

// A half-space of layers of linear elements, `depth` mean free paths deep each, under light at normal incidence.
struct LayeredHalfSpace {
  double reflectance;  // M / q on these elements
  double exact;        // M / q
  double decay;        // depth of an element in lengths over which the slowest mode falls by e
};

// albedo in [0, 1], eta in [1, 3], depth > 0; model diffusion or sp3.
LayeredHalfSpace layered_half_space(double albedo, double eta, double depth, Model model);

// With the boundary that a body's methods have at that eta (boundary_of), found once for many half-spaces.
LayeredHalfSpace layered_half_space(double albedo, const Boundary& boundary, double depth, Model model);

}  // namespace quadgraph
