// Where a body meets the air: bare or under a coat, smooth or rough; shared with C++, see shared.h.
#ifndef QUADGRAPH_OPTICAL_SURFACE_H
#define QUADGRAPH_OPTICAL_SURFACE_H

#include "shared/shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
using glm::max;
using glm::min;
using glm::mix;
#endif

// A coat is a clear layer on the surface, thin beside all else: a film of water, a lacquer (docs/physics.md, "Coats").
struct OpticalSurface {
  float eta;             // index of refraction of the body, over that outside, 1 to 3
  float coat_eta;        // of the coat
  float coat;            // share of the surface that lies under it
  float coat_roughness;  // GGX alpha of its upper side
  float roughness;       // of the facets that light goes in and out by; 0: smooth
  uvec2 boundary;        // address of BOUNDARY_VALUES numbers; of a rough one alone
};

// GGX alpha by which a surface of that roughness turns what goes in and out: below a coat of nearly its index facets
// bend light little, and the upper side of the coat by its own; variances of slopes times how far they turn light add.
QG_INLINE float facet_roughness(float alpha, OpticalSurface surface) {
  if (surface.coat == 0.0f || alpha == 0.0f) return alpha;
  float turned = max(surface.eta - 1.0f, 0.05f);
  float below = alpha * (surface.eta - surface.coat_eta) / turned;
  float above = surface.coat_roughness * (surface.coat_eta - 1.0f) / turned;
  return sqrt(min(mix(alpha * alpha, below * below + above * above, surface.coat), 1.0f));
}

// What a rough surface mirrors of light from outside, at the squares of even steps of its cosine; then the mean cosine
// inside of what goes in, at the same; then what it mirrors of light from inside, at even steps of its cosine there.
const uint OUTSIDE_STEPS = 32u;
const uint INSIDE_STEPS = 128u;
const uint BOUNDARY_COSINES = OUTSIDE_STEPS + 1u;
const uint BOUNDARY_INSIDE = 2u * (OUTSIDE_STEPS + 1u);
const uint BOUNDARY_VALUES = BOUNDARY_INSIDE + INSIDE_STEPS + 1u;

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
