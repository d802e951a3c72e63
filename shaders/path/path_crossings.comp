#version 460
#extension GL_GOOGLE_include_directive : require
#include "path/path_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;
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
  uvec3 ids = load_uvec3(push.triangles, triangle);
  uint rest = i % (3u * push.stripes);
  cross_triangle(rounded(load_vec3(push.vertices, ids.x)), rounded(load_vec3(push.vertices, ids.y)),
                 rounded(load_vec3(push.vertices, ids.z)), rest / push.stripes, rest % push.stripes, push.stripes);
}
