#version 460
#extension GL_GOOGLE_include_directive : require
#include "path/path_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// Where the lines through the middles of cells cross triangles. Per axis and cell, in the first
// cell whose middle lies behind a crossing: their number times 65536 plus the change of the winding number along the
// axis.
struct PathCrossingsPush {
  PathGrid grid;
  Vec3s vertices;  // mm
  Uvec3s triangles;
  Uints crossings;  // 3 per cell, axis after axis; added to
  Uints flags;      // CELL_SURFACE, or-ed
  Uints triangle;   // per cell that the surface crosses: 1 + the largest of the triangles that do
  uint triangle_count;
  uint stripes;  // invocations per triangle and axis
  PathTools tools;
};
layout(push_constant, scalar) uniform Block { PathCrossingsPush push; };
#define GRID push.grid
#include "path/path_crossings.glsl"
#include "path/path_tools.glsl"

uint triangle;

void crossed(Crossing crossing) {
  uvec3 cell = crossing.column;
  float end = float(GRID.size[crossing.axis]);
  cell[crossing.axis] = uint(clamp(floor(crossing.at), 0.0, end - 1.0));
  if (!cut_away(push.tools, crossing_point(crossing))) atomicOr(push.flags.at[cell_number(GRID, cell)], CELL_SURFACE);
  atomicMax(push.triangle.at[cell_number(GRID, cell)], 1u + triangle);
  float behind = max(floor(crossing.at + 0.5), 0.0);
  if (behind >= end) return;
  cell[crossing.axis] = uint(behind);
  uint at = crossing.axis * cell_count(GRID) + cell_number(GRID, cell);
  atomicAdd(push.crossings.at[at], uint(0x10000 + crossing.turn));
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= 3u * push.stripes * push.triangle_count) return;
  triangle = i / (3u * push.stripes);
  uvec3 ids = push.triangles.at[triangle];
  uint rest = i % (3u * push.stripes);
  cross_triangle(rounded(push.vertices.at[ids.x]), rounded(push.vertices.at[ids.y]),
                 rounded(push.vertices.at[ids.z]), rest / push.stripes, rest % push.stripes, push.stripes);
}
