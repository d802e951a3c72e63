#version 460
#extension GL_GOOGLE_include_directive : require
#include "solver/solve_shared.h"
#include "solver/fields.glsl"
#include "solver/rows.glsl"
#include "shared/stride.glsl"
#include "shared/reduce.glsl"
#include "solver/convergence.glsl"

// product = A p, alpha.
struct CgMultiplyPush {
  RowsRef rows;
  Fields p;
  Fields product;
  SolveStates state;
  Reduction reduction;
  uint count;
};
layout(push_constant, scalar) uniform Block { CgMultiplyPush push; };

void decide(vec3 energy) {
  bvec3 open = unsolved(push.state.at[0].square, push.state.at[0].norm);
  bvec3 failed = bvec3(open.x && !(energy.x > 0.0), open.y && !(energy.y > 0.0), open.z && !(energy.z > 0.0));
  if (any(failed)) stop(push.state, SOLVE_NOT_POSITIVE, first_channel(failed));
  push.state.at[0].alpha = mix(vec3(0), push.state.at[0].rz / energy, open);
}

void main() {
  vec3 energy = vec3(0);
  EACH(i, push.count) {
    Field result = row_times(push.rows, load_row(push.rows, i).sum, push.p, i);
    push.product.at[i] = result;
    energy += product(push.p.at[i], result);
  }
  vec3 total;
  if (!reduce_dispatch(push.reduction, energy, total)) return;
  if (gl_LocalInvocationID.x == 0u) decide(total);
}
