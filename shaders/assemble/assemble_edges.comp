#version 460
#extension GL_GOOGLE_include_directive : require
#include "assemble/assembly_shared.h"
#include "material/optics.h"
#include "solver/stored_rows.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// Weight, one invocation per edge, which has two entries. The elements around edge e are ring[k],
// k from ring_offset[e] to ring_offset[e + 1], tets first; reflecting faces are left out.
struct AssembleEdgesPush {
  RowsRef rows;
  Opticals optical;
  Floats tet_shape;
  Floats face_area;
  Uvec2s edge_entry;
  Uints ring_offset;
  Uints ring;
  Uints face_kinds;
  Boundaries boundaries;  // by body
  uint count;
  uint even;  // 1: the coefficients are the same everywhere
};
layout(push_constant, scalar) uniform Block { AssembleEdgesPush push; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  vec3 stiffness = vec3(0), absorption = vec3(0), relaxation = vec3(0);
  Optical optical = push.optical.at[0];
  uint k = push.ring_offset.at[i], end = push.ring_offset.at[i + 1u];
  for (; k < end; ++k) {
    uint element = push.ring.at[k];
    uint index = element >> 3u, edge = element & 7u;
    if (edge == RING_FACE) break;
    if (push.even == 0u) optical = push.optical.at[index];
    float mass = push.tet_shape.at[TET_SHAPE * index + 6u] / 20.0;
    stiffness += kappa(optical) * push.tet_shape.at[TET_SHAPE * index + edge];
    absorption += optical.sigma_a * mass;
    relaxation += relaxation_of(optical) * mass;
  }
  float area = 0.0;
  uint body = 0u;
  for (; k < end; ++k) {
    uint face = push.ring.at[k] >> 3u;
    area += push.face_area.at[face] / 12.0;
    body = body_behind(push.face_kinds, face);
  }
  Boundary boundary = push.boundaries.at[body];
  uvec2 entries = push.edge_entry.at[i];
  store_terms(push.rows, entries.x, stiffness, absorption, relaxation, area, boundary);
  store_terms(push.rows, entries.y, stiffness, absorption, relaxation, area, boundary);
}
