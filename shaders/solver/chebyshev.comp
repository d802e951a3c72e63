#version 460
#extension GL_GOOGLE_include_directive : require
#include "solver/solve_shared.h"
#include "solver/fields.glsl"
#include "solver/rows.glsl"
#include "shared/stride.glsl"
#include "shared/reduce.glsl"
#include "solver/convergence.glsl"

layout(push_constant, scalar) uniform Block { ChebyshevPush push; };

Field step_at(uint i) {
  Row row = load_row(push.rows, i);
  Field r;
  if (push.zero == 1u) {
    r = load_field(push.f, i);
  } else {
    r = residual(push.rows, row.sum, push.f, push.from, i);
  }
  Field d = scaled(0.5 * push.add * load_vec3(push.damping, 0), solved(row.diagonal, r));
  if (push.first == 0u) d = add_scaled(d, vec3(push.keep), load_field(push.d, i));
  if (push.last == 0u) push.d.at[i] = d;
  Field x = d;
  if (push.zero == 0u) x = add(load_field(push.from, i), d);
  if (push.zero == 0u || push.last == 1u) push.to.at[i] = x;
  return x;
}

void main() {
  vec3 own = vec3(0);
  EACH(i, push.count) own += product(load_field(push.f, i), step_at(i));
  if (push.reduce == 0u) return;
  vec3 rz;
  if (!reduce_dispatch(push.reduction, own, rz)) return;
  if (gl_LocalInvocationID.x == 0u) take_preconditioned(push.state, rz);
}
