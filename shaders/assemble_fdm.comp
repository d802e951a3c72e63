#version 460
#extension GL_GOOGLE_include_directive : require
#include "optics.h"
#include "solve_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block {
  AssembleFdmPush push;
};

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  uint slice = i / SLICE_ROWS;
  uint begin = push.rows.slice_offset.at[slice] + i % SLICE_ROWS;
  uint end = push.rows.slice_offset.at[slice + 1u];
  vec3 position = push.nodes.at[i];
  float sum = 0.0;  // 1/mm^2, of 1/d^2
  for (uint e = begin; e < end; e += SLICE_ROWS) {
    uint j = push.rows.column.at[e];
    vec3 step = push.nodes.at[j] - position;
    float weight = j == i ? 0.0 : 1.0 / dot(step, step);
    push.rows.weight.at[e] = vec3(-weight);
    sum += weight;
  }
  Optical own = push.optical.at[i];
  if (i < push.tet_count) {
    push.rows.diagonal.at[i] = vec3(sum) + own.sigma_a / kappa(own);
  } else {
    // (1 + h) kappa_k / (kappa_s h d^2) with h = 2 A kappa_s / d.
    vec3 h = 2.0 * push.mismatch * kappa(own) * sqrt(sum);
    vec3 inner_kappa = kappa(push.optical.at[push.rows.column.at[begin]]);
    push.rows.diagonal.at[i] = (1.0 + h) / h * inner_kappa / kappa(own) * sum;
  }
  push.to_phi.at[i] = 1.0 / kappa(own);
}
