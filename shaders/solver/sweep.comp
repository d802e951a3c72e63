#version 460
#extension GL_GOOGLE_include_directive : require
#include "solver/solve_shared.h"
#include "solver/fields.glsl"
#include "solver/rows.glsl"
#include "shared/stride.glsl"
#include "shared/reduce.glsl"
#include "solver/convergence.glsl"

// to = from + damping (b - A from) / D. With `sweeps` > 0 it also takes the residual of `from`, counts that
// many sweeps as done and stops a relaxation that grows.
struct SweepPush {
  RowsRef rows;
  Fields b;
  Fields from;
  Fields to;
  Vec3s damping;
  SolveStates state;
  Reduction reduction;
  uint count;
  uint sweeps;
};
layout(push_constant, scalar) uniform Block { SweepPush push; };

// A relaxation that converges never exceeds its start by this much; one that diverges does at once.
const float divergence = 1e3;

void decide(vec3 square) {
  vec3 norm = push.state.at[0].norm;
  float worst = worst_residual(square, norm);
  push.state.at[0].square = square;
  push.state.at[0].residual = worst;
  push.state.at[0].iterations += push.sweeps;
  if (any(not_finite(square))) {
    stop(push.state, SOLVE_NOT_FINITE, first_channel(not_finite(square)));
  } else if (worst > divergence * max(1.0, push.state.at[0].checked)) {
    stop(push.state, SOLVE_DIVERGED, first_channel(greaterThanEqual(square, vec3(worst * worst) * norm)));
  }
}

void main() {
  vec3 square = vec3(0);
  EACH(i, push.count) {
    Row row = load_row(push.rows, i);
    Field r = residual(push.rows, row.sum, push.b, push.from, i);
    Field z = solved(row.diagonal, r);
    push.to.at[i] = add_scaled(push.from.at[i], push.damping.at[0], z);
    square += product(r, z);
  }
  if (push.sweeps == 0u) return;
  vec3 rz;
  if (!reduce_dispatch(push.reduction, square, rz)) return;
  if (gl_LocalInvocationID.x == 0u) decide(rz);
}
