#version 460
#extension GL_GOOGLE_include_directive : require
#include "assemble/assembly_shared.h"
#include "material/optics.h"
#include "solver/stored_rows.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// Weight, row_sum and diagonal where the coefficients are the same everywhere, and with them the index of refraction,
// one invocation per vertex. What entries and rows are made of is that of row_structure.h, FemShape; entries from
// `area_count` on have no area.
struct AssembleEvenPush {
  RowsRef rows;
  Opticals optical;  // one
  Vec2s entry_shape;
  Floats entry_area;
  Vec2s row_shape;
  Boundaries boundaries;  // by body, all alike
  uint count;
  uint area_count;
};
layout(push_constant, scalar) uniform Block { AssembleEvenPush push; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  Optical optical = push.optical.at[0];
  vec3 kappa_all = kappa(optical), relaxation = relaxation_of(optical);
  uint slice = i / SLICE_ROWS;
  uint end = push.rows.slice_offset.at[slice + 1u];
  RowBoundary boundary = RowBoundary(push.boundaries, 0u, 0u);
  Entry sum = entry_of(vec3(0), vec3(0), vec3(0));
  for (uint e = push.rows.slice_offset.at[slice] + i % SLICE_ROWS; e < end; e += SLICE_ROWS) {
    vec2 shape = push.entry_shape.at[e];
    float area = 0.0;
    if (e < push.area_count) area = push.entry_area.at[e];
    sum = sum_of(sum, store_terms(push.rows, e, shape.x * kappa_all, shape.y * optical.sigma_a, shape.y * relaxation,
                                  area, boundary.all.at[0]));
  }
  vec2 shape = push.row_shape.at[i];
  store_row(push.rows, i, shape.x * optical.sigma_a, shape.x * relaxation, shape.y, boundary, sum);
}
