#version 460
#extension GL_GOOGLE_include_directive : require
#include "assemble/assembly_shared.h"
#include "material/optics.h"
#include "assemble/polygrid.h"
#include "solver/stored_rows.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// Weight, diagonal and to_phi, one invocation per vertex. Entry k of a row is link k.
struct AssemblePolygridPush {
  RowsRef rows;
  Vec3s vertices;
  Uvec3s faces;
  Uints face_offset;
  Uints face_incidence;
  Opticals optical;  // of the vertices
  Floats volume;
  Vec3s to_phi;
  Boundaries boundaries;  // of the one body
  uint count;          // vertices
  uint surface_count;  // of them on the surface
  uint published;      // 1: differences of kappa phi, 0: of the flux
};
layout(push_constant, scalar) uniform Block { AssemblePolygridPush push; };

#include "shared/face_area.glsl"

vec3 kappa_at(uint vertex) {
  return kappa(push.optical.at[vertex]);
}

// What multiplies kappa phi of the neighbour (published) or phi, per weight, and what the node itself.
struct Pair {
  vec3 own, other;
};

Pair pair_of(vec3 here, vec3 there) {
  if (push.published == 1u) return Pair(vec3(1), vec3(1));
  vec3 between = 2.0 * here * there / (here + there);
  return Pair(between, between);
}

// A third of the area of the open faces around a surface vertex, mm^2.
float open_area(uint i) {
  float area = 0.0;
  uint end = push.face_offset.at[i + 1u];
  for (uint k = push.face_offset.at[i]; k < end; ++k) {
    area += area_of(push.faces, push.vertices, push.face_incidence.at[k]) / 3.0;
  }
  return area;
}

void store(uint i, Entry row_sum, Entry entries) {
  push.rows.row_sum.at[i] = row_sum;
  push.rows.diagonal.at[i] = difference_of(row_sum, entries);
}

void surface_row(uint i, uint entry, vec3 here) {
  uint inner = column_of(stored_entry(push.rows, entry));
  vec3 there = kappa_at(inner);
  float open = open_area(i);
  float per_distance = (open > 0.0 ? open : 1.0) / length(push.vertices.at[inner] - push.vertices.at[i]);
  Pair pair = pair_of(here, there);
  if (push.published == 1u) pair.other = here / there;
  Entry stored = store_entry(push.rows, entry, entry_of(-per_distance * pair.other, vec3(0), vec3(0)));
  vec3 measure = push.published == 1u ? open / here : vec3(open);
  Entry row_sum = sum_of(entry_of(per_distance * (pair.own - pair.other), vec3(0), vec3(0)),
                         boundary_entry(push.boundaries.at[0], measure));
  store(i, row_sum, stored);
}

void inner_row(uint i, uint begin, vec3 here) {
  vec3 position = push.vertices.at[i];
  GridOffsets offsets;
  uint link[GRID_LINKS];
  for (int k = 0; k < GRID_LINKS; ++k) {
    link[k] = column_of(stored_entry(push.rows, begin + uint(k) * SLICE_ROWS));
    offsets.at[k] = push.vertices.at[link[k]] - position;
  }
  GridWeights weights = grid_weights(offsets);
  float volume = push.volume.at[i];
  Entry sum = entry_of(vec3(0), vec3(0), vec3(0));
  for (int k = 0; k < GRID_LINKS; ++k) {
    vec3 weight = weights.at[k] * volume * pair_of(here, kappa_at(link[k])).other;
    Entry entry = store_entry(push.rows, begin + uint(k) * SLICE_ROWS, entry_of(-weight, vec3(0), vec3(0)));
    sum = sum_of(sum, entry);
  }
  Optical own = push.optical.at[i];
  vec3 mass = push.published == 1u ? volume / here : vec3(volume);
  store(i, entry_of(vec3(0), own.sigma_a * mass, relaxation_of(own) * mass), sum);
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  vec3 here = kappa_at(i);
  push.to_phi.at[i] = push.published == 1u ? 1.0 / here : vec3(1);
  uint begin = push.rows.slice_offset.at[i / SLICE_ROWS] + i % SLICE_ROWS;
  if (i < push.surface_count) {
    surface_row(i, begin, here);
  } else {
    inner_row(i, begin, here);
  }
}
