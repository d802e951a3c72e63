// What the passes that fill an operator and its right-hand side share with C++, in scalar layout; see shared.h.
#ifndef QUADGRAPH_ASSEMBLY_SHARED_H
#define QUADGRAPH_ASSEMBLY_SHARED_H

#include "solver/solve_shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
#endif

// Floats of a tet's shape, times its etendue: grad l_i . grad l_j V of its edges 01, 02, 03, 12, 13, 23 (mm), and its
// volume (mm^3).
const uint TET_SHAPE = 7u;

// The elements around an edge: tet * 8 + edge of the tet, or face * 8 + RING_FACE.
const uint RING_FACE = 7u;

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
