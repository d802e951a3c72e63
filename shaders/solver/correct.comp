#version 460
#extension GL_GOOGLE_include_directive : require
#include "solver/solve_shared.h"
#include "solver/fields.glsl"
#include "shared/stride.glsl"

// x += z, and counts the iteration.
struct CorrectPush {
  Fields z;
  Fields x;
  SolveStates state;
  uint count;
};
layout(push_constant, scalar) uniform Block { CorrectPush push; };

void main() {
  if (gl_GlobalInvocationID.x == 0u) push.state.at[0].iterations += 1u;
  EACH(i, push.count) push.x.at[i] = add(push.x.at[i], push.z.at[i]);
}
