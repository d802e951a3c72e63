#version 460
#extension GL_GOOGLE_include_directive : require
#include "solver/solve_shared.h"
#include "solver/fields.glsl"
#include "material/optics.h"
#include "solver/stored_rows.glsl"
#include "shared/stride.glsl"
#include "shared/reduce.glsl"
#include "solver/convergence.glsl"

// x += alpha p, r -= alpha A p; without multigrid also beta.
struct CgUpdatePush {
  Entries diagonal;
  Fields p;
  Fields product;
  Fields x;
  Fields r;
  SolveStates state;
  Reduction reduction;
  uint count;
  uint multigrid;
};
layout(push_constant, scalar) uniform Block { CgUpdatePush push; };

void decide(vec3 square) {
  vec3 norm = push.state.at[0].norm;
  if (push.multigrid == 0u) {
    push.state.at[0].beta = mix(vec3(0), square / push.state.at[0].rz, unsolved(push.state.at[0].square, norm));
    push.state.at[0].rz = square;
  }
  push.state.at[0].square = square;
  push.state.at[0].residual = worst_residual(square, norm);
  push.state.at[0].iterations += 1u;
  if (any(not_finite(square))) stop(push.state, SOLVE_NOT_FINITE, first_channel(not_finite(square)));
}

void main() {
  vec3 own = vec3(0);
  vec3 alpha = push.state.at[0].alpha;
  EACH(i, push.count) {
    push.x.at[i] = add_scaled(push.x.at[i], alpha, push.p.at[i]);
    Field r = add_scaled(push.r.at[i], -alpha, push.product.at[i]);
    push.r.at[i] = r;
    own += product(r, solved(load_diagonal(push.diagonal, i), r));
  }
  vec3 square;
  if (!reduce_dispatch(push.reduction, own, square)) return;
  if (gl_LocalInvocationID.x == 0u) decide(square);
}
