// Where a body meets the air: smooth, and bare or under a coat; shared with C++, see shared.h.
#ifndef QUADGRAPH_OPTICAL_SURFACE_H
#define QUADGRAPH_OPTICAL_SURFACE_H

#include "shared/shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

// A coat is a clear layer on the surface, thin beside all else: a film of water, a lacquer (docs/physics.md, "Coats").
struct OpticalSurface {
  float eta;             // index of refraction of the body, over that outside, 1 to 3
  float coat_eta;        // of the coat
  float coat;            // share of the surface that lies under it
  float coat_roughness;  // GGX alpha of its upper side
};

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
