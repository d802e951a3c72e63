#version 460
#extension GL_GOOGLE_include_directive : require
#include "material/material.h"
#include "path/path_shared.h"
#include "material/edits.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// What the cells cost.
struct PathCostPush {
  PathGrid grid;
  Uints flags;
  Uints nearest;   // path_flood.comp; null: cells lie where they do at rest, and depth does not matter
  Uints triangle;  // path_crossings.comp
  Uvec3s triangles;
  Vec3s vertices;  // mm
  Vec3s rest;      // the same at rest
  PathMaterials body;
  Floats cost;  // written
};
layout(push_constant, scalar) uniform Block { PathCostPush push; };

// A place at rest, mm, and how deep below the surface it then is, mm.
struct Place {
  vec3 position;
  float depth;
};

float triangle_distance(vec3 p, vec3 a, vec3 b, vec3 c) {
  vec3 n = cross(b - a, c - a);
  bool over = dot(cross(b - a, p - a), n) >= 0.0 && dot(cross(c - b, p - b), n) >= 0.0 &&
              dot(cross(a - c, p - c), n) >= 0.0;
  if (over) return abs(dot(p - a, n)) / max(length(n), 1e-30);
  return min(segment_distance(p, a, b), min(segment_distance(p, b, c), segment_distance(p, c, a)));
}

// Two edges of a triangle and its normal, as long as the edges are on the average.
mat3 frame_of(vec3 a, vec3 b, vec3 c) {
  vec3 n = cross(b - a, c - a);
  return mat3(b - a, c - a, n * inversesqrt(max(length(n), 1e-30)));
}

// The place at rest of a cell: what lies below the surface moves with the nearest triangle.
Place place_at_rest(vec3 middle, uint i) {
  uint nearest = push.nearest.at[i];
  uvec3 ids = push.triangles.at[push.triangle.at[nearest] - 1u];
  vec3 a = push.vertices.at[ids.x], b = push.vertices.at[ids.y], c = push.vertices.at[ids.z];
  vec3 at = push.rest.at[ids.x], bt = push.rest.at[ids.y], ct = push.rest.at[ids.z];
  Place place = Place(middle, 0.0);
  mat3 now = frame_of(a, b, c);
  if (a != at || b != bt || c != ct) place.position = at + frame_of(at, bt, ct) * (inverse(now) * (middle - a));
  place.depth = triangle_distance(place.position, at, bt, ct);
  return place;
}

Optical optical_cell(PathMaterial body, uvec3 cell) {
  return body.optical.at[cell.x + body.optical_size.x * (cell.y + body.optical_size.y * cell.z)];
}

// Coefficients of a grid at a position, trilinear as in engine/scene/volume.h.
Optical volume_at(PathMaterial body, vec3 position) {
  vec3 last = vec3(body.optical_size - 1u);
  vec3 place = clamp((position - body.optical_first) / body.optical_spacing, vec3(0), last);
  uvec3 low = uvec3(place), high = min(low + 1u, body.optical_size - 1u);
  vec3 t = place - vec3(low);
  Optical rows[4];
  for (uint k = 0u; k < 4u; ++k) {
    uvec3 from = uvec3(low.x, (k & 1u) == 0u ? low.y : high.y, (k & 2u) == 0u ? low.z : high.z);
    rows[k] = mixed(optical_cell(body, from), optical_cell(body, uvec3(high.x, from.yz)), t.x);
  }
  return mixed(mixed(rows[0], rows[1], t.y), mixed(rows[2], rows[3], t.y), t.z);
}

Optical optical_at(PathMaterial body, Place place) {
  Optical optical = uvec2(body.optical) != uvec2(0) ? volume_at(body, place.position)
                                                    : material_at(body.material, place.position, place.depth);
  AllEdits edits = AllEdits(body.edits, body.points, body.texels, body.edit_count, push.grid.cell);
  return edited_at(edits, optical, place.position, place.depth);
}

void main() {
  uint i = gl_GlobalInvocationID.x, count = cell_count(push.grid);
  if (i >= count) return;
  vec3 cost = vec3(-1);
  if ((push.flags.at[i] & CELL_SOLID) != 0u) {
    vec3 middle = middle_of(push.grid, cell_at(push.grid, i));
    PathMaterial body = push.body.at[0];
    Place place = Place(middle, 0.0);
    if (uvec2(push.nearest) != uvec2(0)) place = place_at_rest(middle, i);
    Optical optical = optical_at(body, place);
    vec3 extinction = optical.sigma_a + optical.sigma_s_prime;
    cost = body.cost == COST_EXTINCTION ? extinction : sqrt(3.0 * optical.sigma_a * extinction);
  }
  for (uint c = 0u; c < 3u; ++c) push.cost.at[c * count + i] = cost[c];
}
