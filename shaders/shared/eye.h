// Where a picture is seen from, for GLSL and C++: the eye's place (mm, w 1) or, of parallel rays, the unit direction
// towards it (w 0); see shared.h.
#ifndef QUADGRAPH_EYE_H
#define QUADGRAPH_EYE_H

#include "shared/shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
using glm::normalize;
#endif

// Unit, from a point in the picture, mm.
QG_INLINE vec3 towards_eye(vec4 eye, vec3 position) {
  return normalize(vec3(eye) - eye.w * position);
}

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
