// Storing b of an operator's rows, and its norm.
#ifndef QUADGRAPH_RIGHT_HAND_SIDE_GLSL
#define QUADGRAPH_RIGHT_HAND_SIDE_GLSL

#include "solver/fields.glsl"
#include "solver/solve_shared.h"
#include "solver/stored_rows.glsl"
#include "shared/stride.glsl"
#include "shared/reduce.glsl"

// Stores b of row i. Returns its part of b^T D^-1 b.
vec3 store_b(RightHandSideRef side, uint i, Field b) {
  side.b.at[i] = b;
  return product(b, solved(load_diagonal(side.diagonal, i), b));
}

// Stores b^T D^-1 b, the sum of `square` over all invocations, each of which must call this.
void store_norm(RightHandSideRef side, vec3 square) {
  vec3 norm;
  if (!reduce_dispatch(side.reduction, square, norm)) return;
  if (gl_LocalInvocationID.x == 0u) side.state.at[0].norm = norm;
}

#endif
