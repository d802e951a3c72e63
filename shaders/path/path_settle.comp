#version 460
#extension GL_GOOGLE_include_directive : require
#include "path/path_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// After the last round of path_relax.comp: the first copy of the lengths is the one that holds.
struct PathSettlePush {
  PathGrid grid;
  Floats paths;
  CoherentUints copies;
};
layout(push_constant, scalar) uniform Block { PathSettlePush push; };

void main() {
  uint i = gl_GlobalInvocationID.x, count = cell_count(push.grid);
  if (i >= count) return;
  uvec3 blocks = push.grid.size / PATH_BLOCK, block = cell_at(push.grid, i) / PATH_BLOCK;
  uint number = block.x + blocks.x * (block.y + blocks.y * block.z), all = blocks.x * blocks.y * blocks.z;
  for (uint c = 0u; c < 3u; ++c) {
    if (push.copies.at[number + c * all] % 2u == 1u) push.paths.at[c * count + i] = push.paths.at[(3u + c) * count + i];
  }
}
