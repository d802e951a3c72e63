#version 460
#extension GL_GOOGLE_include_directive : require
#include "solver/solve_shared.h"
#include "solver/fields.glsl"
#include "solver/rows.glsl"
#include "shared/stride.glsl"
#include "shared/reduce.glsl"
#include "solver/convergence.glsl"

// One step of Chebyshev's iteration for A x = f, preconditioned by a majorant M of A (majorant.comp):
//   d <- keep d + add M^-1 (f - A from),  to = from + d.
// `first`: d is not read. `zero`: from is 0 and not read. `last`: d is not written. With `zero` and without `last`, to
// is not written either: it would be d. `reduce`: also f^T to, for the direction.
struct ChebyshevPush {
  RowsRef rows;
  Fields f;
  Fields from;
  Fields to;
  Fields d;
  Entries majorant;
  SolveStates state;
  Reduction reduction;
  uint count;
  uint first, zero, last, reduce;
  float keep;
  float add;
};
layout(push_constant, scalar) uniform Block { ChebyshevPush push; };

Field step_at(uint i) {
  Field r;
  if (push.zero == 1u) {
    r = push.f.at[i];
  } else {
    r = residual(push.rows, load_row(push.rows, i).sum, push.f, push.from, i);
  }
  Field d = scaled(vec3(push.add), times(push.majorant.at[i], r));
  if (push.first == 0u) d = add_scaled(d, vec3(push.keep), push.d.at[i]);
  if (push.last == 0u) push.d.at[i] = d;
  Field x = d;
  if (push.zero == 0u) x = add(push.from.at[i], d);
  if (push.zero == 0u || push.last == 1u) push.to.at[i] = x;
  return x;
}

void main() {
  vec3 own = vec3(0);
  EACH(i, push.count) own += product(push.f.at[i], step_at(i));
  if (push.reduce == 0u) return;
  vec3 rz;
  if (!reduce_dispatch(push.reduction, own, rz)) return;
  if (gl_LocalInvocationID.x == 0u) take_preconditioned(push.state, rz);
}
