#version 460
#extension GL_GOOGLE_include_directive : require
#include "path/path_light_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;
#include "path/path_entering.glsl"
#define GRID push.grid
#include "path/path_crossings.glsl"
#include "path/path_tools.glsl"

vec3 normal;  // unit, of the triangle, as its corners turn

// Whether the cell at a point is inside; in cells.
bool inside(vec3 place) {
  ivec3 cell = ivec3(floor(place));
  if (any(lessThan(cell, ivec3(0))) || any(greaterThanEqual(cell, ivec3(GRID.size)))) return false;
  return (push.flags.at[cell_number(GRID, uvec3(cell))] & CELL_INSIDE) != 0u;
}

// Whether a cell or one that it shares a corner with is inside: then the surface here is no sheet.
bool beside_inside(uvec3 cell) {
  for (int k = 0; k < 27; ++k) {
    ivec3 other = ivec3(cell) + ivec3(k % 3, k / 3 % 3, k / 9) - 1;
    if (any(lessThan(other, ivec3(0))) || any(greaterThanEqual(other, ivec3(GRID.size)))) continue;
    if ((push.flags.at[cell_number(GRID, uvec3(other))] & CELL_INSIDE) != 0u) return true;
  }
  return false;
}

void crossed(Crossing crossing) {
  uvec3 cell = crossing.column;
  cell[crossing.axis] = uint(clamp(floor(crossing.at), 0.0, float(GRID.size[crossing.axis]) - 1.0));
  vec3 position = crossing_point(crossing);
  if (cut_away(push.tools, position)) return;
  // Out is where the cells are not inside, whatever the corners say; a sheet is lit from both sides. A cell away along
  // the normal: along a line that grazes the surface, which side comes first is a matter of chance.
  vec3 place = (position - GRID.origin) / GRID.cell;
  bool before = inside(place - normal), behind = inside(place + normal);
  vec3 entering = entering_at(position, behind && !before ? -normal : normal);
  if (before == behind && !beside_inside(cell)) entering = max(entering, entering_at(position, -normal));
  enter(cell_number(GRID, cell), entering);
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= 3u * push.stripes * push.triangle_count) return;
  uvec3 ids = push.triangles.at[i / (3u * push.stripes)];
  uint rest = i % (3u * push.stripes);
  vec3 a = push.vertices.at[ids.x], b = push.vertices.at[ids.y], c = push.vertices.at[ids.z];
  vec3 doubled = cross(b - a, c - a);
  normal = doubled / max(length(doubled), 1e-30);
  cross_triangle(rounded(a), rounded(b), rounded(c), rest / push.stripes, rest % push.stripes, push.stripes);
}
