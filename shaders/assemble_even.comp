#version 460
#extension GL_GOOGLE_include_directive : require
#include "assembly_shared.h"
#include "optics.h"
#include "entries.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { AssembleEvenPush push; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  Optical optical = push.optical.at[0];
  vec3 kappa_all = kappa(optical), relaxation = relaxation_of(optical);
  uint slice = i / SLICE_ROWS;
  uint end = push.rows.slice_offset.at[slice + 1u];
  Entry sum = entry_of(vec3(0), vec3(0), vec3(0));
  for (uint e = push.rows.slice_offset.at[slice] + i % SLICE_ROWS; e < end; e += SLICE_ROWS) {
    vec2 shape = push.entry_shape.at[e];
    Entry entry = entry_of(shape.x * kappa_all, shape.y * optical.sigma_a, shape.y * relaxation);
    if (e < push.area_count) entry = sum_of(entry, boundary_entry(push.boundary, vec3(push.entry_area.at[e])));
    push.rows.weight.at[e] = entry;
    sum = sum_of(sum, entry);
  }
  vec2 shape = push.row_shape.at[i];
  Entry row_sum = sum_of(entry_of(vec3(0), shape.x * optical.sigma_a, shape.x * relaxation),
                         boundary_entry(push.boundary, vec3(shape.y)));
  push.rows.row_sum.at[i] = row_sum;
  push.rows.diagonal.at[i] = difference_of(row_sum, sum);
}
