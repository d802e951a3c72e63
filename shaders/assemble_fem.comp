#version 460
#extension GL_GOOGLE_include_directive : require
#include "optics.h"
#include "solve_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block {
  AssembleFemPush push;
};

uint row_begin;

void add(uint place, vec3 value) {
  push.rows.weight.at[row_begin + place * SLICE_ROWS] += value;
}

// Adds one tet to the row of its corner `own`; returns what belongs on the diagonal.
vec3 add_tet(uvec2 incidence) {
  uint tet = incidence.x >> 2u, own = incidence.x & 3u;
  uvec4 corners = push.tets.at[tet];
  vec3 p = push.vertices.at[corners[own]];
  vec3 e1 = push.vertices.at[corners[own == 0u ? 1u : 0u]] - p;
  vec3 e2 = push.vertices.at[corners[own <= 1u ? 2u : 1u]] - p;
  vec3 e3 = push.vertices.at[corners[own <= 2u ? 3u : 2u]] - p;
  // The gradient of corner k is n_k / (6 V), up to an orientation that cancels in products.
  vec3 n1 = cross(e2, e3), n2 = cross(e3, e1), n3 = cross(e1, e2);
  vec3 n0 = -(n1 + n2 + n3);
  float six_volume = abs(dot(e1, n1));
  Optical optical = push.optical.at[tet];
  vec3 stiffness = kappa(optical) / (6.0 * six_volume);
  vec3 mass = optical.sigma_a * (six_volume / 120.0);
  vec3 k1 = stiffness * dot(n0, n1), k2 = stiffness * dot(n0, n2), k3 = stiffness * dot(n0, n3);
  add(incidence.y & 1023u, k1 + mass);
  add(incidence.y >> 10u & 1023u, k2 + mass);
  add(incidence.y >> 20u, k3 + mass);
  // Minus the sum of the other entries, not n0.n0: constants then carry no flux, to rounding.
  return 2.0 * mass - (k1 + k2 + k3);
}

vec3 add_face(uvec2 incidence) {
  uvec3 corners = push.faces.at[incidence.x];
  vec3 p = push.vertices.at[corners.x];
  float area = 0.5 * length(cross(push.vertices.at[corners.y] - p, push.vertices.at[corners.z] - p));
  vec3 mass = vec3(area / (24.0 * push.mismatch));
  add(incidence.y & 1023u, mass);
  add(incidence.y >> 10u & 1023u, mass);
  return 2.0 * mass;
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  uint slice = i / SLICE_ROWS;
  row_begin = push.rows.slice_offset.at[slice] + i % SLICE_ROWS;
  uint end = push.rows.slice_offset.at[slice + 1u];
  for (uint e = row_begin; e < end; e += SLICE_ROWS) push.rows.weight.at[e] = vec3(0);
  vec3 diagonal = vec3(0);
  for (uint k = push.tet_offset.at[i]; k < push.tet_offset.at[i + 1u]; ++k) {
    diagonal += add_tet(push.tet_incidence.at[k]);
  }
  if (i < push.surface_count) {
    for (uint k = push.face_offset.at[i]; k < push.face_offset.at[i + 1u]; ++k) {
      diagonal += add_face(push.face_incidence.at[k]);
    }
  }
  push.rows.diagonal.at[i] = diagonal;
}
