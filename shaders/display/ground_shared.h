// The ground under the body and the shadow that it has where they meet; see shared.h.
#ifndef QUADGRAPH_GROUND_SHARED_H
#define QUADGRAPH_GROUND_SHARED_H

#include "light/render_shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

// Texels along a side of the map of the ground, and how far its shadow is spread, in texels.
const uint GROUND_SIZE = 128u;
const int GROUND_SPREAD = 14;

// How dark the ground is where the body stands on it.
const float GROUND_STRENGTH = 0.9f;

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
