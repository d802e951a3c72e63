// What the smooth surface of a body does to the fields inside: one matrix, for every method and model.
#pragma once

#include "engine/base/solve_options.h"
#include "engine/optics/optical_surface.h"

namespace quadgraph {

// The outward flux of the pair (phi, phi2) is K (phi, phi2), the exitance M = k11 phi + k12 phi2 - reflected q.
// K is symmetric and positive definite; with Model::diffusion only k11 = 1/(2A) is used, the others are 0.
struct Boundary {
  double k11 = 0, k12 = 0, k22 = 0;
  // Diffuse source only, else 0: light q enters as if phi outside were source q, so that b gains the integral of
  // (k11, k12) source q; and M loses reflected q.
  double source = 0, reflected = 0;

  bool operator==(const Boundary&) const = default;
};

// From the exact Fresnel moments; for the published baselines (quadgraph-fdm and polygrid, diffuse source, diffusion)
// from the published polynomial F_dr and A [QG Eq. 2, 6], which know no coat. `model` is not `automatic`, eta in [1,
// 3].
//
// K is that of Klose and Larsen 2006 (docs/physics.md, "Boundary matrix"), replaced by its symmetric part, in the
// variables (phi, phi2) of operator.h. Its k11 with phi2 = 0 is the two-moment 1/(2A), A = (1 + 3 R2) / (1 - 2 R1).
Boundary boundary_of(Method method, Source source, Model model, const OpticalSurface& surface);

}  // namespace quadgraph
