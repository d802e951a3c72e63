#version 460
#extension GL_GOOGLE_include_directive : require
#include "assembly_shared.h"
#include "optics.h"
#include "entries.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { AssembleFvPush push; };

vec3 vertex(uvec4 tet, uint k) {
  return push.vertices.at[tet[k & 3u]];
}

// The link of tet t across face k: area / (d_i/kappa_i + d_j/kappa_j), mm^2, or area kappa_i / d_i to a surface node.
vec3 conductance(uint t, uint k, out float area) {
  uvec4 tet = push.tets.at[t];
  uint j = push.links.at[t][k];
  vec3 point = vertex(tet, k + 1u);
  vec3 twice_area = cross(vertex(tet, k + 2u) - point, vertex(tet, k + 3u) - point);
  float size = length(twice_area);
  area = 0.5 * size;
  vec3 resistance = vec3(abs(dot(twice_area, push.nodes.at[t] - point))) / kappa(push.optical.at[t]);
  if (j < push.tet_count) {
    resistance += vec3(abs(dot(twice_area, push.nodes.at[j] - point))) / kappa(push.optical.at[j]);
  }
  return vec3(area * size) / resistance;
}

uint face_towards(uint t, uint node) {
  uint k = 0u;
  while (k < 3u && push.links.at[t][k] != node) ++k;
  return k;
}

float volume(uint t) {
  uvec4 tet = push.tets.at[t];
  vec3 p = vertex(tet, 0u);
  return dot(vertex(tet, 1u) - p, cross(vertex(tet, 2u) - p, vertex(tet, 3u) - p)) / 6.0;
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  uint slice = i / SLICE_ROWS;
  uint begin = push.rows.slice_offset.at[slice] + i % SLICE_ROWS;
  uint end = push.rows.slice_offset.at[slice + 1u];
  vec3 sum = vec3(0);
  float area = 0.0;
  for (uint e = begin; e < end; e += SLICE_ROWS) {
    uint j = push.rows.column.at[e];
    vec3 g = vec3(0);
    if (j != i) {
      uint tet = i < push.tet_count ? i : j;
      g = conductance(tet, face_towards(tet, i < push.tet_count ? j : i), area);
    }
    push.rows.weight.at[e] = entry_of(-g, vec3(0), vec3(0));
    sum += g;
  }
  push.to_phi.at[i] = vec3(1);
  if (i < push.tet_count) {
    Optical optical = push.optical.at[i];
    float size = volume(i);
    push.rows.row_sum.at[i] = entry_of(vec3(0), optical.sigma_a * size, relaxation_of(optical) * size);
  } else {
    bool open = push.face_kinds.at[i - push.tet_count] == FACE_OPEN;
    push.rows.row_sum.at[i] = boundary_entry(push.boundary, vec3(open ? area : 0.0));
  }
  push.rows.diagonal.at[i] = sum_of(push.rows.row_sum.at[i], entry_of(sum, vec3(0), vec3(0)));
}
