#version 460
#extension GL_GOOGLE_include_directive : require
#include "assemble/assembly_shared.h"
#include "material/optics.h"
#include "solver/stored_rows.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { AssembleEdgesPush push; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  vec3 stiffness = vec3(0), absorption = vec3(0), relaxation = vec3(0);
  Optical optical = load_optical(push.optical, 0);
  uint k = load_assembly_uint(push.ring_offset, i), end = load_assembly_uint(push.ring_offset, i + 1u);
  for (; k < end; ++k) {
    uint element = load_assembly_uint(push.ring, k);
    uint index = element >> 3u, edge = element & 7u;
    if (edge == RING_FACE) break;
    if (push.even == 0u) optical = load_optical(push.optical, index);
    float mass = load_assembly_float(push.tet_shape, TET_SHAPE * index + 6u) / 20.0;
    stiffness += kappa(optical) * load_assembly_float(push.tet_shape, TET_SHAPE * index + edge);
    absorption += optical.sigma_a * mass;
    relaxation += relaxation_of(optical) * mass;
  }
  float area = 0.0;
  for (; k < end; ++k) area += load_assembly_float(push.face_area, load_assembly_uint(push.ring, k) >> 3u) / 12.0;
  uvec2 entries = load_assembly_uvec2(push.edge_entry, i);
  store_terms(push.rows, entries.x, stiffness, absorption, relaxation, area, push.boundary);
  store_terms(push.rows, entries.y, stiffness, absorption, relaxation, area, push.boundary);
}
