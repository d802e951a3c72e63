#version 460
#extension GL_GOOGLE_include_directive : require
#include "solver/solve_shared.h"
#include "solver/fields.glsl"
#include "material/optics.h"
#include "solver/stored_rows.glsl"
#include "shared/stride.glsl"

// p = z + beta p; without multigrid z = r / D.
struct CgDirectionPush {
  Entries diagonal;
  Fields r;
  Fields z;
  Fields p;
  SolveStates state;
  uint count;
  uint multigrid;
};
layout(push_constant, scalar) uniform Block { CgDirectionPush push; };

void main() {
  vec3 beta = push.state.at[0].beta;
  EACH(i, push.count) {
    Field direction;
    if (push.multigrid == 1u) {
      direction = push.z.at[i];
    } else {
      direction = solved(load_diagonal(push.diagonal, i), push.r.at[i]);
    }
    // The old direction of the first iteration is no number one may count on.
    if (beta != vec3(0)) direction = add_scaled(direction, beta, push.p.at[i]);
    push.p.at[i] = direction;
  }
}
