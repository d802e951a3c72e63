#version 460
#extension GL_GOOGLE_include_directive : require
#include "path/path_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// Along the lines of one axis, in how many of its two directions a cell's middle is inside: where
// the changes of the winding number along the line add up to 0, in both where that is not 0 here; else, where a
// surface is open or does not know its outside, where an odd number of crossings lies on the way.
struct PathWindingPush {
  PathGrid grid;
  Uints crossings;  // of the axis, replaced
  uint axis;
};
layout(push_constant, scalar) uniform Block { PathWindingPush push; };

// The low half, with its sign.
int turn_of(uint crossings) {
  return bitfieldExtract(int(crossings), 0, 16);
}

uint number_of(uint crossings) {
  return uint(int(crossings) - turn_of(crossings)) >> 16u;
}

void main() {
  uint u = (push.axis + 1u) % 3u, v = (push.axis + 2u) % 3u;
  uint column = gl_GlobalInvocationID.x;
  if (column >= push.grid.size[u] * push.grid.size[v]) return;
  uvec3 cell = uvec3(0);
  cell[u] = column % push.grid.size[u];
  cell[v] = column / push.grid.size[u];
  uint first = cell_number(push.grid, cell);
  cell[push.axis] = 1u;
  uint step = cell_number(push.grid, cell) - first, end = push.grid.size[push.axis];
  int turns = 0;
  uint number = 0u;
  for (uint k = 0u; k < end; ++k) {
    uint here = push.crossings.at[first + k * step];
    turns += turn_of(here);
    number += number_of(here);
  }
  int before = 0;
  uint passed = 0u;
  for (uint k = 0u; k < end; ++k) {
    uint here = push.crossings.at[first + k * step];
    before += turn_of(here);
    passed += number_of(here);
    uint odd = (passed & 1u) + ((number - passed) & 1u);
    push.crossings.at[first + k * step] = turns != 0 ? odd : before != 0 ? 2u : 0u;
  }
}
