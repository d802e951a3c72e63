#version 460
#extension GL_GOOGLE_include_directive : require
#include "assembly_shared.h"
#include "optics.h"
#include "entries.glsl"
#include "stored_entries.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { AssembleEvenPush push; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  Optical optical = load_optical(push.optical, 0);
  vec3 kappa_all = kappa(optical), relaxation = relaxation_of(optical);
  uint slice = i / SLICE_ROWS;
  uint end = load_row_uint(push.rows.slice_offset, slice + 1u);
  Entry sum = entry_of(vec3(0), vec3(0), vec3(0));
  for (uint e = load_row_uint(push.rows.slice_offset, slice) + i % SLICE_ROWS; e < end; e += SLICE_ROWS) {
    vec2 shape = load_assembly_vec2(push.entry_shape, e);
    Entry entry = entry_of(shape.x * kappa_all, shape.y * optical.sigma_a, shape.y * relaxation);
    if (e < push.area_count) {
      vec3 area = vec3(load_assembly_float(push.entry_area, e));
      entry = sum_of(entry, boundary_entry(push.boundary, area));
    }
    sum = sum_of(sum, store_entry(push.rows, e, entry));
  }
  vec2 shape = load_assembly_vec2(push.row_shape, i);
  Entry row_sum = sum_of(entry_of(vec3(0), shape.x * optical.sigma_a, shape.x * relaxation),
                         boundary_entry(push.boundary, vec3(shape.y)));
  push.rows.row_sum.at[i] = row_sum;
  push.rows.diagonal.at[i] = difference_of(row_sum, sum);
}
