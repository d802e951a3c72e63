#version 460
#extension GL_GOOGLE_include_directive : require
#include "path/path_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// For all cells one that the surface crosses, the nearest but for rare exceptions, by jump flooding
// (Rong and Tan 2006): the nearest of those that the 27 cells in steps of `step` know. With step 0: the cell itself.
struct PathFloodPush {
  PathGrid grid;
  Uints triangle;
  Uints from;
  Uints to;  // number of a cell; NO_CELL
  uint step;
};
layout(push_constant, scalar) uniform Block { PathFloodPush push; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= cell_count(push.grid)) return;
  if (push.step == 0u) {
    push.to.at[i] = push.triangle.at[i] > 0u ? i : NO_CELL;
    return;
  }
  ivec3 cell = ivec3(cell_at(push.grid, i));
  uint best = NO_CELL;
  int least = 0x7fffffff;
  for (int k = 0; k < 27; ++k) {
    ivec3 other = cell + int(push.step) * (ivec3(k % 3, k / 3 % 3, k / 9) - 1);
    if (any(lessThan(other, ivec3(0))) || any(greaterThanEqual(other, ivec3(push.grid.size)))) continue;
    uint known = push.from.at[cell_number(push.grid, uvec3(other))];
    if (known == NO_CELL) continue;
    ivec3 away = ivec3(cell_at(push.grid, known)) - cell;
    int distance = away.x * away.x + away.y * away.y + away.z * away.z;
    if (distance < least || (distance == least && known < best)) {
      least = distance;
      best = known;
    }
  }
  push.to.at[i] = best;
}
