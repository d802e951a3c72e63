// What views of the inside are drawn from, in scalar layout; see shared.h.
#ifndef QUADGRAPH_FALSE_COLOUR_SHARED_H
#define QUADGRAPH_FALSE_COLOUR_SHARED_H

#include "shared/eye.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

// Flags of a triangle, the same at its three corners. The edge opposite corner k is drawn dark: FALSE_EDGE << k.
const uint FALSE_EDGE = 1u;
const uint FALSE_SHADED = 8u;   // darker where it is seen from the side
const uint FALSE_PLAIN = 16u;   // grey, whatever its value
const uint FALSE_BEHIND = 32u;  // only what lies behind the cutting plane is drawn

struct FalseVertex {
  vec3 position;  // mm
  float value;    // 0 to 1 along the colour bar
  uint flags;
};

#ifndef __cplusplus
QG_ARRAY(FalseVertices, FalseVertex);
#endif

// false_colour.vert, false_colour.frag.
struct FalseColourPush {
  mat4 clip_from_offset;           // as of a SurfaceScene
  QG_REF(FalseVertices) vertices;  // three per triangle
  vec3 origin;                     // mm
  vec4 eye;                        // shared/eye.h
  vec4 plane;                      // FALSE_BEHIND: drawn where dot(plane.xyz, position) <= plane.w
  uint diverging;                  // colour map
};

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
