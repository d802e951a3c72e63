// The ground under the body and the shadow that it has where they meet, in scalar layout;
// tests/cpp/render/layout_test.cpp compares it with the compiled shaders.
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

// ground_map.comp: how dark every texel of the ground is, from the depth of the body seen from below.
struct GroundMapPush {
  QG_REF(Floats) depth;   // GROUND_SIZE^2, 0 on the ground to 1 at `far`
  QG_REF(Floats) shadow;  // the same, share of the light that is missing; written
  float far;              // mm
  float reach;            // mm above the ground from which a surface still darkens it by 1/e
};

// ground.comp: darkens what is seen beside the body. The shadow counts as coverage without light.
struct GroundPush {
  QG_REF(Floats) shadow;
  QG_REF(Floats) alpha;  // per pixel, written
  vec3 eye;              // mm, from the middle of the map
  vec3 corner;           // direction from the eye to the upper left corner of the picture
  vec3 right;            // from there to the upper right one
  vec3 down;             // to the lower left one
  float half_width;      // mm, of the map
  uint z_up;             // 1: the ground lies across z; 0: across y
  uint width;            // pixels
  uint height;
};

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
