#version 460
#extension GL_GOOGLE_include_directive : require
#include "assemble/assembly_shared.h"
#include "material/optics.h"
#include "solver/stored_rows.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// Weight, diagonal and to_phi of engine/reference/operator.h, one invocation per node.
struct AssembleFdmPush {
  RowsRef rows;
  Vec3s nodes;
  Opticals optical;
  Vec3s to_phi;
  Uints face_kinds;
  Boundaries boundaries;  // by body
  uint count;      // nodes
  uint tet_count;  // inner nodes
};
layout(push_constant, scalar) uniform Block { AssembleFdmPush push; };

// Sum of the row of a surface node, with the inner node behind it at distance 1 / inverse_distance.
Entry surface_row_sum(uint node, uint inner, float inverse_distance) {
  vec3 own = kappa(push.optical.at[node]);
  vec3 ratio = kappa(push.optical.at[inner]) / own;
  Entry entry = entry_of((ratio - 1.0) * (inverse_distance * inverse_distance), vec3(0), vec3(0));
  uint face = node - push.tet_count;
  if (!is_open(push.face_kinds, face)) return entry;
  Boundary boundary = push.boundaries.at[body_behind(push.face_kinds, face)];
  return sum_of(entry, boundary_entry(boundary, ratio / own * inverse_distance));
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  uint slice = i / SLICE_ROWS;
  uint begin = push.rows.slice_offset.at[slice] + i % SLICE_ROWS;
  uint end = push.rows.slice_offset.at[slice + 1u];
  vec3 position = push.nodes.at[i];
  float inverse_square = 0.0;  // 1/mm^2, of the last link
  Entry sum = entry_of(vec3(0), vec3(0), vec3(0));
  for (uint e = begin; e < end; e += SLICE_ROWS) {
    uint j = column_of(stored_entry(push.rows, e));
    vec3 step = push.nodes.at[j] - position;
    float weight = j == i ? 0.0 : 1.0 / dot(step, step);
    sum = sum_of(sum, store_entry(push.rows, e, entry_of(vec3(-weight), vec3(0), vec3(0))));
    if (j != i) inverse_square = weight;
  }
  Optical own = push.optical.at[i];
  vec3 to_phi = 1.0 / kappa(own);
  push.to_phi.at[i] = to_phi;
  uint inner = column_of(stored_entry(push.rows, begin));
  Entry row_sum = i < push.tet_count ? entry_of(vec3(0), own.sigma_a * to_phi, relaxation_of(own) * to_phi)
                                     : surface_row_sum(i, inner, sqrt(inverse_square));
  push.rows.row_sum.at[i] = row_sum;
  push.rows.diagonal.at[i] = difference_of(row_sum, sum);
}
