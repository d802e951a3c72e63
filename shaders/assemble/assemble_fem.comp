#version 460
#extension GL_GOOGLE_include_directive : require
#include "assemble/assembly_shared.h"
#include "material/optics.h"
#include "solver/stored_rows.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// Diagonal from the weights, one invocation per vertex. Its tets and open faces are incidence[k], k
// from offset[v] to offset[v + 1].
struct AssembleFemPush {
  RowsRef rows;
  Opticals optical;
  Floats tet_shape;
  Floats face_area;
  Uints tet_offset;
  Uints tet_incidence;
  Uints face_offset;
  Uints face_incidence;
  Uints face_kinds;
  Boundaries boundaries;  // by body
  uint count;
  uint surface_count;
  uint even;    // 1: the coefficients are the same everywhere
  uint bodies;  // as of Sp3Head
};
layout(push_constant, scalar) uniform Block { AssembleFemPush push; };

Entry off_diagonal_sum(uint i) {
  uint slice = i / SLICE_ROWS;
  uint end = push.rows.slice_offset.at[slice + 1u];
  Entry sum = entry_of(vec3(0), vec3(0), vec3(0));
  for (uint e = push.rows.slice_offset.at[slice] + i % SLICE_ROWS; e < end; e += SLICE_ROWS) {
    sum = sum_of(sum, load_entry(push.rows, e));
  }
  return sum;
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  vec3 absorption = vec3(0), relaxation = vec3(0);
  Optical optical = push.optical.at[0];
  uint end = push.tet_offset.at[i + 1u];
  for (uint k = push.tet_offset.at[i]; k < end; ++k) {
    uint tet = push.tet_incidence.at[k];
    if (push.even == 0u) optical = push.optical.at[tet];
    float mass = push.tet_shape.at[TET_SHAPE * tet + 6u] / 20.0;
    absorption += optical.sigma_a * mass;
    relaxation += relaxation_of(optical) * mass;
  }
  float area = 0.0;
  uint body = 0u;
  if (i < push.surface_count) {
    end = push.face_offset.at[i + 1u];
    for (uint k = push.face_offset.at[i]; k < end; ++k) {
      uint face = push.face_incidence.at[k];
      area += push.face_area.at[face] / 12.0;
      body = body_behind(push.face_kinds, face);
    }
  }
  // Consistent masses: of a tet's twenty parts five belong to each of its vertices, of a face's twelve four.
  store_row(push.rows, i, 5.0 * absorption, 5.0 * relaxation, 4.0 * area,
            RowBoundary(push.boundaries, body, push.bodies), off_diagonal_sum(i));
}
