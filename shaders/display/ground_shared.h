// The ground under the body: the shadow that it has where they meet, and the light that it gets from the body; see
// shared.h.
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

// Of light from the body: texels along a side of its map, bounding radii from its middle to its sides, and from which
// share of these on it fades, to nothing at the sides; parts of the surface that send it, at most.
const uint GROUND_LIGHT_SIZE = 80u;
const float GROUND_LIGHT_REACH = 3.0f;
const float GROUND_LIGHT_FADES = 0.5f;
const uint GROUND_PATCHES = 512u;

// Share of the light that the ground, a diffuser, sends back.
const float GROUND_ALBEDO = 0.3f;

// A part of the surface, as light from it arrives afar.
struct GroundPatch {
  vec3 place;             // mm, its middle
  float area;             // mm^2
  vec3 facing;            // mm^2: area along the normal, summed over its faces
  vec3 red, green, blue;  // W: the same, with each face's exitance
};

#ifndef __cplusplus
QG_ARRAY(GroundPatches, GroundPatch);

#endif

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
