#version 460
#extension GL_GOOGLE_include_directive : require
#include "solve_shared.h"
#include "fields.glsl"
#include "rows.glsl"
#include "reduce.glsl"
#include "convergence.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { CgStartPush push; };

void decide(vec3 rz) {
  vec3 norm = push.state.at[0].norm;
  float worst = worst_residual(rz, norm);
  bool falls = push.first == 1u || worst <= 0.5 * push.state.at[0].checked;
  uint iterations = push.first == 1u ? 0u : push.state.at[0].iterations;
  push.state.at[0].rz = rz;
  push.state.at[0].residual = worst;
  push.state.at[0].checked = worst;
  push.state.at[0].iterations = iterations;
  if (any(not_finite(rz + norm))) {
    stop(push.state, SOLVE_NOT_FINITE, first_channel(not_finite(rz + norm)));
  } else if (!any(unconverged(rz, norm, push.tolerance))) {
    stop(push.state, SOLVE_CONVERGED, 0u);
  } else if (!falls) {
    // The recursive residual had met the tolerance, but the true one no longer falls.
    stop(push.state, SOLVE_STAGNATED, 0u);
  } else if (iterations >= push.max_iterations) {
    stop(push.state, SOLVE_EXHAUSTED, 0u);
  } else {
    push.state.at[0].iterate = uvec3(gl_NumWorkGroups.x, 1u, 1u);
    push.state.at[0].check = uvec3(0);
    push.state.at[0].status = SOLVE_RUNNING;
  }
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  vec3 square = vec3(0);
  if (i < push.count) {
    Field r = residual(push.rows, push.b, push.x, i);
    Field z = solved(push.rows.diagonal.at[i], r);
    push.r.at[i] = r;
    push.p.at[i] = z;
    square = product(r, z);
  }
  vec3 rz;
  if (!reduce_dispatch(push.reduction, square, rz)) return;
  if (gl_LocalInvocationID.x == 0u) decide(rz);
}
