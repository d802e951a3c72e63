#version 460
#extension GL_GOOGLE_include_directive : require
#include "assemble/assembly_shared.h"
#include "material/optics.h"
#include "solver/stored_rows.glsl"

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
    float area = 0.0;
    if (e < push.area_count) area = load_assembly_float(push.entry_area, e);
    sum = sum_of(sum, store_terms(push.rows, e, shape.x * kappa_all, shape.y * optical.sigma_a, shape.y * relaxation,
                                  area, push.boundary));
  }
  vec2 shape = load_assembly_vec2(push.row_shape, i);
  store_row(push.rows, i, shape.x * optical.sigma_a, shape.x * relaxation, shape.y, push.boundary, sum);
}
