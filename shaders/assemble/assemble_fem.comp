#version 460
#extension GL_GOOGLE_include_directive : require
#include "assemble/assembly_shared.h"
#include "material/optics.h"
#include "solver/stored_rows.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { AssembleFemPush push; };

Entry off_diagonal_sum(uint i) {
  uint slice = i / SLICE_ROWS;
  uint end = load_row_uint(push.rows.slice_offset, slice + 1u);
  Entry sum = entry_of(vec3(0), vec3(0), vec3(0));
  for (uint e = load_row_uint(push.rows.slice_offset, slice) + i % SLICE_ROWS; e < end; e += SLICE_ROWS) {
    sum = sum_of(sum, load_entry(push.rows, e));
  }
  return sum;
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  vec3 absorption = vec3(0), relaxation = vec3(0);
  Optical optical = load_optical(push.optical, 0);
  uint end = load_assembly_uint(push.tet_offset, i + 1u);
  for (uint k = load_assembly_uint(push.tet_offset, i); k < end; ++k) {
    uint tet = load_assembly_uint(push.tet_incidence, k);
    if (push.even == 0u) optical = load_optical(push.optical, tet);
    float mass = load_assembly_float(push.tet_shape, TET_SHAPE * tet + 6u) / 20.0;
    absorption += optical.sigma_a * mass;
    relaxation += relaxation_of(optical) * mass;
  }
  float area = 0.0;
  if (i < push.surface_count) {
    end = load_uint(push.face_offset, i + 1u);
    for (uint k = load_uint(push.face_offset, i); k < end; ++k) {
      area += load_assembly_float(push.face_area, load_uint(push.face_incidence, k)) / 12.0;
    }
  }
  // Consistent masses: of a tet's twenty parts five belong to each of its vertices, of a face's twelve four.
  store_row(push.rows, i, 5.0 * absorption, 5.0 * relaxation, 4.0 * area, push.boundary, off_diagonal_sum(i));
}
