// Random numbers from integers alone, alike on every device and in C++.
#ifndef QUADGRAPH_RANDOM_H
#define QUADGRAPH_RANDOM_H

#include "shared/shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

// PCG-RXS-M-XS of 32 bits (Jarzynski and Olano 2020).
QG_INLINE uint hash(uint x) {
  uint state = x * 747796405u + 2891336453u;
  uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
  return (word >> 22u) ^ word;
}

// Number `n` of a sequence that fills [0, 1) evenly, and with those of the other dimensions the cube: the additive
// recurrence by powers of 1 / x, x^7 = x + 1, for up to six of them (Roberts 2018), from a start at random.
const uint SPREAD_DIMENSIONS = 6u;
const uint SPREAD_STEPS[6] = {3859688306u, 3468523225u, 3117001274u, 2801104767u, 2517223198u, 2262111973u};

QG_INLINE float spread_number(uint start, uint n, uint dimension) {
  return float((hash(start + dimension) + n * SPREAD_STEPS[dimension]) >> 8u) * (1.0f / 16777216.0f);
}

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
