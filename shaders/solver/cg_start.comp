#version 460
#extension GL_GOOGLE_include_directive : require
#include "solver/solve_shared.h"
#include "solver/fields.glsl"
#include "solver/rows.glsl"
#include "shared/stride.glsl"
#include "shared/reduce.glsl"
#include "solver/convergence.glsl"

// r = b - A x and its norm; decides whether to iterate. Without multigrid also p = r / D.
struct CgStartPush {
  RowsRef rows;
  Fields b;
  Fields x;
  Fields r;
  Fields p;
  SolveStates state;
  Reduction reduction;
  uint count;
  float tolerance;
  uint what;  // START_*
  uint multigrid;
};
layout(push_constant, scalar) uniform Block { CgStartPush push; };

// A true residual up to this many times the recursive one confirms it.
const float confirmed = 2.0;
// Below this no change of the surface says anything in single precision: the residual itself has to be as small.
const float SMALLEST_CHANGE = 1e-6;

// After the surface had met the tolerance: is the residual what the recursion said?
void check(float worst) {
  float before = push.state.at[0].checked;
  float recursive = push.tolerance < SMALLEST_CHANGE ? 0.0 : confirmed * push.state.at[0].residual;
  if (worst <= max(recursive, push.tolerance)) {
    stop(push.state, SOLVE_CONVERGED, 0u);
  } else if (push.state.at[0].restarts > 0u && worst > 0.5 * before) {
    stop(push.state, SOLVE_STAGNATED, 0u);
  } else {
    // What the recursion has lost may be little of the residual and most of the energy that is missing: a restart has
    // to show anew how fast the surface changes.
    push.state.at[0].restarts += 1u;
    push.state.at[0].looks = 0u;
    open(push.state);
  }
}

void start(float worst) {
  push.state.at[0].earlier = push.what == START_AGAIN ? push.state.at[0].earlier + push.state.at[0].iterations : 0u;
  push.state.at[0].iterations = 0u;
  push.state.at[0].slow = 0u;
  push.state.at[0].looks = 0u;
  push.state.at[0].restarts = 0u;
  push.state.at[0].change = vec3(0);
  push.state.at[0].algebraic = vec3(-1);
  if (worst > 0.0) {
    open(push.state);
  } else {
    push.state.at[0].algebraic = vec3(0);
    stop(push.state, SOLVE_CONVERGED, 0u);
  }
}

void decide(vec3 square) {
  vec3 norm = push.state.at[0].norm;
  float worst = worst_residual(square, norm);
  if (any(not_finite(square + norm))) {
    stop(push.state, SOLVE_NOT_FINITE, first_channel(not_finite(square + norm)));
  } else if (push.what == START_FIRST || push.what == START_AGAIN) {
    start(worst);
  } else if (push.what == START_CHECK) {
    check(worst);
  }
  push.state.at[0].square = square;
  push.state.at[0].residual = worst;
  if (push.what == START_RESIDUAL) return;
  push.state.at[0].rz = push.multigrid == 1u ? vec3(0) : square;
  push.state.at[0].looked = worst;
  push.state.at[0].checked = worst;
}

void main() {
  vec3 own = vec3(0);
  EACH(i, push.count) {
    Row row = load_row(push.rows, i);
    Field r = residual(push.rows, row.sum, push.b, push.x, i);
    Field z = solved(row.diagonal, r);
    push.r.at[i] = r;
    if (push.multigrid == 0u) push.p.at[i] = z;
    own += product(r, z);
  }
  vec3 square;
  if (!reduce_dispatch(push.reduction, own, square)) return;
  if (gl_LocalInvocationID.x == 0u) decide(square);
}
