#version 460
#extension GL_GOOGLE_include_directive : require
#include "assembly_shared.h"
#include "optics.h"
#include "entries.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { AssembleFdmPush push; };

// Sum of the row of a surface node, with the inner node behind it at distance 1 / inverse_distance.
Entry surface_row_sum(uint node, uint inner, float inverse_distance) {
  vec3 own = kappa(push.optical.at[node]);
  vec3 ratio = kappa(push.optical.at[inner]) / own;
  Entry entry = entry_of((ratio - 1.0) * (inverse_distance * inverse_distance), vec3(0), vec3(0));
  if (push.face_kinds.at[node - push.tet_count] != FACE_OPEN) return entry;
  return sum_of(entry, boundary_entry(push.boundary, ratio / own * inverse_distance));
}

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
    push.rows.weight.at[e] = entry_of(vec3(-weight), vec3(0), vec3(0));
    sum += weight;
  }
  Optical own = push.optical.at[i];
  vec3 to_phi = 1.0 / kappa(own);
  push.to_phi.at[i] = to_phi;
  Entry row_sum = i < push.tet_count ? entry_of(vec3(0), own.sigma_a * to_phi, relaxation_of(own) * to_phi)
                                     : surface_row_sum(i, push.rows.column.at[begin], sqrt(sum));
  push.rows.row_sum.at[i] = row_sum;
  push.rows.diagonal.at[i] = sum_of(row_sum, entry_of(vec3(sum), vec3(0), vec3(0)));
}
