// Where the surface of a body is smooth, by the same code on the GPU and in the CPU reference.
#ifndef QUADGRAPH_CREASES_H
#define QUADGRAPH_CREASES_H

#include "shared/shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
using glm::smoothstep;
#endif

// Faces whose normals are farther apart than 45 degrees meet in a crease of the body, which stays sharp; below 35 they
// are smooth, and in between by a share, so that nothing jumps while a body bends. The bake's creases are at 40
// degrees.
const float CREASE_COSINE = 0.70710678f;
const float SMOOTH_COSINE = 0.81915204f;

// How far the surface is smooth where faces meet whose unit normals have that cosine, 0 to 1.
QG_INLINE float smooth_share(float cosine) {
  return smoothstep(CREASE_COSINE, SMOOTH_COSINE, cosine);
}

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
