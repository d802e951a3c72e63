// Which model a scene needs: what diffusion would get wrong, from closed forms.
#pragma once

#include <glm/vec2.hpp>
#include <span>

#include "engine/base/solve_options.h"
#include "shaders/shared/shared.h"

namespace quadgraph {

// Relative error of diffusion that Model::automatic accepts. At 1% it takes diffusion for marble, milk, cream and
// spectralon, where both models are within 1% of transport (docs/accuracy.md).
inline constexpr double model_tolerance = 0.01;

// How far diffusion is from SP3, relatively: the larger of the difference in what a half-space sends back of light at
// normal incidence, and in its decay per diffusion length. albedo sigma_s' / sigma_t in [0, 1], eta in [1, 3].
double diffusion_error(double albedo, double eta);

// Smallest albedo of any channel; 0 where there is a clear region. Procedural materials mix two sets of coefficients,
// and the albedo of a mixture lies between theirs.
double least_albedo(const gpu::Material& material);
double least_albedo(std::span<const gpu::Optical> optical);

// Largest of gpu::packed_rounding, on elements of size `spacing` (mm); at least 1.
glm::vec2 packed_rounding(const gpu::Material& material, float spacing);
glm::vec2 packed_rounding(std::span<const gpu::Optical> optical, float spacing);

// `wanted`; for `automatic` diffusion where it was published (quadgraph-fdm and polygrid with the diffuse source knows
// no other model) and where its error at `albedo` is at most model_tolerance, else sp3.
Model resolve_model(Model wanted, Method method, Source source, double albedo, double eta);

}  // namespace quadgraph
