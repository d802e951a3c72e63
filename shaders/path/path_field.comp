#version 460
#extension GL_GOOGLE_include_directive : require
#include "path/path_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// What leaves the surface: exp(-length) in the cells that it crosses. Deeper cells are darker or
// brighter by what a cell costs, and the cells around have no paths: both count only where no other cell is near.
struct PathFieldPush {
  PathGrid grid;
  Uints flags;
  Floats paths;
  Vec4s field;  // W/mm^2 times weight, and the weight; written
};
layout(push_constant, scalar) uniform Block { PathFieldPush push; };

bool solid(uint cell) {
  return (push.flags.at[cell] & CELL_SOLID) != 0u;
}

vec3 leaving(uint cell) {
  uint count = cell_count(push.grid);
  vec3 paths;
  for (uint c = 0u; c < 3u; ++c) paths[c] = push.paths.at[c * count + cell];
  return exp(-paths);
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= cell_count(push.grid)) return;
  if (solid(i)) {
    bool surface = (push.flags.at[i] & (CELL_SURFACE | CELL_CUT)) != 0u;
    push.field.at[i] = (surface ? 1.0 : FIELD_BELOW) * vec4(leaving(i), 1.0);
    return;
  }
  vec4 sum = vec4(0);
  ivec3 cell = ivec3(cell_at(push.grid, i));
  for (int k = 0; k < 27; ++k) {
    ivec3 other = cell + ivec3(k % 3, k / 3 % 3, k / 9) - 1;
    if (any(lessThan(other, ivec3(0))) || any(greaterThanEqual(other, ivec3(push.grid.size)))) continue;
    uint number = cell_number(push.grid, uvec3(other));
    if (solid(number)) sum += vec4(leaving(number), 1.0);
  }
  push.field.at[i] = sum.w > 0.0 ? FIELD_BESIDE * sum / sum.w : vec4(0);
}
