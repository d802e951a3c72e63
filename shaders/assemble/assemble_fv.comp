#version 460
#extension GL_GOOGLE_include_directive : require
#include "assemble/assembly_shared.h"
#include "material/optics.h"
#include "solver/stored_rows.glsl"
#include "solver/tet_volume.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// Weight, diagonal and to_phi, one invocation per node.
struct AssembleFvPush {
  RowsRef rows;
  Vec3s vertices;
  Uvec4s tets;
  Uvec4s links;
  Vec3s nodes;
  Opticals optical;
  Floats etendue;  // as of BodyRef
  Vec3s to_phi;
  Uints face_kinds;
  Boundaries boundaries;  // by body
  uint count;      // nodes
  uint tet_count;  // inner nodes
  LeastTet least;
};
layout(push_constant, scalar) uniform Block { AssembleFvPush push; };

vec3 vertex(uvec4 tet, uint k) {
  return push.vertices.at[tet[k & 3u]];
}

// Height of a node over a face, times twice the area of the face.
float height(vec3 twice_area, vec3 away, float least) {
  return max(abs(dot(twice_area, away)), least);
}

vec3 conduction(uint t) {
  return number_or_one(push.etendue, t) * kappa(push.optical.at[t]);
}

// The link of tet t across face k: area / (d_i/kappa_i + d_j/kappa_j), mm^2, or area kappa_i / d_i to a surface node.
vec3 conductance(uint t, uint k, out float area) {
  uvec4 tet = push.tets.at[t];
  uint j = push.links.at[t][k];
  vec3 point = vertex(tet, k + 1u);
  vec3 twice_area = cross(vertex(tet, k + 2u) - point, vertex(tet, k + 3u) - point);
  float size = length(twice_area);
  area = 0.5 * size;
  float least = push.least.quality * size * sqrt(size);
  float height_t = height(twice_area, push.nodes.at[t] - point, least);
  vec3 resistance = vec3(height_t) / conduction(t);
  if (j < push.tet_count) {
    float height_j = height(twice_area, push.nodes.at[j] - point, least);
    resistance += vec3(height_j) / conduction(j);
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
  return tet_volume(vertex(tet, 1u) - p, vertex(tet, 2u) - p, vertex(tet, 3u) - p, push.least);
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  uint slice = i / SLICE_ROWS;
  uint begin = push.rows.slice_offset.at[slice] + i % SLICE_ROWS;
  uint end = push.rows.slice_offset.at[slice + 1u];
  Entry sum = entry_of(vec3(0), vec3(0), vec3(0));
  float area = 0.0;
  for (uint e = begin; e < end; e += SLICE_ROWS) {
    uint j = column_of(stored_entry(push.rows, e));
    vec3 g = vec3(0);
    if (j != i) {
      // From the same side for both rows, so that they get the same number: surface nodes come after the inner ones.
      g = conductance(min(i, j), face_towards(min(i, j), max(i, j)), area);
    }
    sum = sum_of(sum, store_entry(push.rows, e, entry_of(-g, vec3(0), vec3(0))));
  }
  push.to_phi.at[i] = vec3(1);
  Entry row_sum;
  if (i < push.tet_count) {
    Optical optical = push.optical.at[i];
    float size = number_or_one(push.etendue, i) * volume(i);
    row_sum = entry_of(vec3(0), optical.sigma_a * size, relaxation_of(optical) * size);
  } else {
    uint face = i - push.tet_count;
    bool open = is_open(push.face_kinds, face);
    row_sum = boundary_entry(push.boundaries.at[body_behind(push.face_kinds, face)], vec3(open ? area : 0.0));
  }
  push.rows.row_sum.at[i] = row_sum;
  push.rows.diagonal.at[i] = difference_of(row_sum, sum);
}
