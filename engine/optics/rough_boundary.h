// What a rough surface reflects (docs/physics.md, "Rough surfaces").
#pragma once

namespace quadgraph {

// Share of even light from outside that a surface of GGX roughness `alpha`, 0 to 1, reflects towards a view at outside
// cosine `cosine`, 0 to 1, eta = inside / outside. That of a smooth one where alpha is 0; to 2e-3.
double rough_reflectance(double cosine, double alpha, double eta);

}  // namespace quadgraph
