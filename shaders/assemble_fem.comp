#version 460
#extension GL_GOOGLE_include_directive : require
#include "solve_shared.h"
#include "optics.h"
#include "entries.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { AssembleFemPush push; };

// Sums over the elements around an edge, or over all edges of a row.
struct Sums {
  vec3 stiffness, absorption, relaxation;
  float area;
};

// Everything at the edge of an entry: the tets around it and, on the surface, two faces.
Sums around_edge(uint entry) {
  Sums sums = Sums(vec3(0), vec3(0), vec3(0), 0.0);
  for (uint k = push.ring_offset.at[entry]; k < push.ring_offset.at[entry + 1u]; ++k) {
    uint element = push.ring.at[k];
    uint index = element >> 3u, edge = element & 7u;
    if (edge == RING_FACE) {
      sums.area += push.face_area.at[index] / 12.0;
      continue;
    }
    Optical optical = push.optical.at[index];
    float mass = push.tet_shape.at[TET_SHAPE * index + 6u] / 20.0;
    sums.stiffness += kappa(optical) * push.tet_shape.at[TET_SHAPE * index + edge];
    sums.absorption += optical.sigma_a * mass;
    sums.relaxation += relaxation_of(optical) * mass;
  }
  return sums;
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  uint slice = i / SLICE_ROWS;
  uint end = push.rows.slice_offset.at[slice + 1u];
  Sums row = Sums(vec3(0), vec3(0), vec3(0), 0.0);
  for (uint e = push.rows.slice_offset.at[slice] + i % SLICE_ROWS; e < end; e += SLICE_ROWS) {
    Sums edge = around_edge(e);
    push.rows.weight.at[e] = sum_of(entry_of(edge.stiffness, edge.absorption, edge.relaxation),
                                    boundary_entry(push.boundary, vec3(edge.area)));
    row.stiffness += edge.stiffness;
    row.absorption += edge.absorption;
    row.relaxation += edge.relaxation;
    row.area += edge.area;
  }
  // A vertex meets every tet around it along three edges and every face along two; consistent masses have twice the
  // weight on the diagonal. Constants carry no flux: the stiffness there is minus the sum of the others.
  push.rows.diagonal.at[i] =
      sum_of(entry_of(-row.stiffness, 2.0 / 3.0 * row.absorption, 2.0 / 3.0 * row.relaxation),
             boundary_entry(push.boundary, vec3(row.area)));
  push.rows.row_sum.at[i] = sum_of(entry_of(vec3(0), 5.0 / 3.0 * row.absorption, 5.0 / 3.0 * row.relaxation),
                                   boundary_entry(push.boundary, vec3(2.0 * row.area)));
}
