// Types of the pass that draws what lies around the body, in scalar layout; tests/cpp/render/layout_test.cpp compares
// them with the compiled shader.
#ifndef QUADGRAPH_SURROUNDINGS_SHARED_H
#define QUADGRAPH_SURROUNDINGS_SHARED_H

#include "shared/image_levels.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

// surroundings.comp: radiance of one environment along the ray of every pixel. Rays are in the frame of its picture:
// right, up, ahead.
struct SurroundingsPush {
  QG_REF(Vec3s) texels;         // by longitude and latitude, its middle ahead
  QG_REF(Floats) surroundings;  // RGB per pixel, W/(mm^2 sr); written
  ImageLevels image;
  vec3 corner;  // ray to the upper left corner of the picture, 1 along the view
  vec3 right;   // from its left to its right
  vec3 down;    // from its top to its bottom
  vec3 power;   // W/(mm^2 sr) of a texel of 1
  uint width;   // pixels
  uint height;
  uint first;  // 1: written, 0: added
};

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
