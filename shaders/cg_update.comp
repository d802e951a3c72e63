#version 460
#extension GL_GOOGLE_include_directive : require
#include "solve_shared.h"
#include "fields.glsl"
#include "reduce.glsl"
#include "convergence.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { CgUpdatePush push; };

void decide(vec3 rz) {
  vec3 norm = push.state.at[0].norm;
  bvec3 was_open = unconverged(push.state.at[0].rz, norm, push.tolerance);
  push.state.at[0].beta = mix(vec3(0), rz / push.state.at[0].rz, was_open);
  push.state.at[0].rz = rz;
  push.state.at[0].residual = worst_residual(rz, norm);
  uint iterations = push.state.at[0].iterations + 1u;
  push.state.at[0].iterations = iterations;
  if (any(not_finite(rz))) {
    stop(push.state, SOLVE_NOT_FINITE, first_channel(not_finite(rz)));
  } else if (!any(unconverged(rz, norm, push.tolerance)) || iterations >= push.max_iterations) {
    push.state.at[0].iterate = uvec3(0);
    push.state.at[0].check = uvec3(gl_NumWorkGroups.x, 1u, 1u);
  }
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  vec3 square = vec3(0);
  if (i < push.count) {
    vec3 alpha = push.state.at[0].alpha;
    push.x.at[i] = add_scaled(push.x.at[i], alpha, push.p.at[i]);
    Field r = add_scaled(push.r.at[i], -alpha, push.product.at[i]);
    push.r.at[i] = r;
    square = product(r, solved(push.diagonal.at[i], r));
  }
  vec3 rz;
  if (!reduce_dispatch(push.reduction, square, rz)) return;
  if (gl_LocalInvocationID.x == 0u) decide(rz);
}
