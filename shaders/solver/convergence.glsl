// What the last workgroup of a solver pass decides.
#ifndef QUADGRAPH_CONVERGENCE_GLSL
#define QUADGRAPH_CONVERGENCE_GLSL

#include "solver/solve_shared.h"

bvec3 not_finite(vec3 v) {
  return bvec3(isnan(v.x) || isinf(v.x), isnan(v.y) || isinf(v.y), isnan(v.z) || isinf(v.z));
}

// Below this residual a channel is left alone: nothing that single precision holds would change.
const float SOLVED = 1e-8;

// A square below which it is left alone, too: sums of such products leave the range of single precision. A channel of
// which nearly all is absorbed before it scatters gets there while the others are far from solved.
const float NEGLIGIBLE = 1e-33;

// Channels that still have a residual; one without light has none.
bvec3 unsolved(vec3 square, vec3 norm) {
  return greaterThan(square, max(SOLVED * SOLVED * norm, vec3(NEGLIGIBLE)));
}

float worst_residual(vec3 square, vec3 norm) {
  vec3 ratio = mix(vec3(0), square / norm, greaterThan(min(square, norm), vec3(NEGLIGIBLE)));
  return sqrt(max(ratio.x, max(ratio.y, ratio.z)));
}

uint first_channel(bvec3 flags) {
  return flags.x ? 0u : flags.y ? 1u : 2u;
}

void open(SolveStates state) {
  for (uint l = 0u; l < MAX_LEVELS; ++l) state.at[0].gate[l] = uvec3(state.at[0].groups[l], 1u, 1u);
  state.at[0].coarse = uvec3(1);
  state.at[0].surface = uvec3(state.at[0].surface_groups, 1u, 1u);
  state.at[0].check = uvec3(0);
  state.at[0].status = SOLVE_RUNNING;
}

void close(SolveStates state) {
  for (uint l = 0u; l < MAX_LEVELS; ++l) state.at[0].gate[l] = uvec3(0);
  state.at[0].coarse = uvec3(0);
  state.at[0].surface = uvec3(0);
  state.at[0].check = uvec3(0);
}

void stop(SolveStates state, uint status, uint channel) {
  close(state);
  state.at[0].status = status;
  state.at[0].channel = channel;
}

// r^T z of a preconditioned residual z, which makes the next direction.
void take_preconditioned(SolveStates state, vec3 rz) {
  vec3 before = state.at[0].rz;
  bvec3 open_channel = unsolved(state.at[0].square, state.at[0].norm);
  state.at[0].beta = mix(vec3(0), rz / before, bvec3(open_channel.x && before.x > 0.0, open_channel.y && before.y > 0.0,
                                                      open_channel.z && before.z > 0.0));
  state.at[0].rz = rz;
  bvec3 failed = bvec3(open_channel.x && !(rz.x > 0.0), open_channel.y && !(rz.y > 0.0), open_channel.z && !(rz.z > 0.0));
  if (any(failed)) stop(state, SOLVE_NOT_POSITIVE, first_channel(failed));
}

#endif
