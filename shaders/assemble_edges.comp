#version 460
#extension GL_GOOGLE_include_directive : require
#include "assembly_shared.h"
#include "optics.h"
#include "entries.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
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
  for (; k < end; ++k) area += push.face_area.at[push.ring.at[k] >> 3u] / 12.0;
  Entry entry =
      sum_of(entry_of(stiffness, absorption, relaxation), boundary_entry(push.boundary, vec3(area)));
  uvec2 entries = push.edge_entry.at[i];
  push.rows.weight.at[entries.x] = entry;
  push.rows.weight.at[entries.y] = entry;
}
