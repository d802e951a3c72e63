#version 460
#extension GL_GOOGLE_include_directive : require
#include "solver/solve_shared.h"
#include "solver/fields.glsl"
#include "solver/rows.glsl"
#include "shared/stride.glsl"

// r = f - A x.
struct ResidualPush {
  RowsRef rows;
  Fields f;
  Fields x;
  Fields r;
  uint count;
};
layout(push_constant, scalar) uniform Block { ResidualPush push; };

void main() {
  EACH(i, push.count) push.r.at[i] = residual(push.rows, load_row(push.rows, i).sum, push.f, push.x, i);
}
