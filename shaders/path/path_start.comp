#version 460
#extension GL_GOOGLE_include_directive : require
#include "path/path_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// Lengths before the first step: -ln of what enters.
struct PathStartPush {
  PathGrid grid;
  Uints flags;
  Uints entering;  // 3 per cell, channel after channel: bits of W/mm^2
  Floats paths;    // the same order, written
  CoherentUints wanted;
  Uints list;    // blocks of round 0: block + blocks * channel
  Uints groups;  // of round 0
  Uints counts;  // PathCounts
};
layout(push_constant, scalar) uniform Block { PathStartPush push; };

void main() {
  uint i = gl_GlobalInvocationID.x, count = cell_count(push.grid);
  if (i >= count) return;
  bool solid = (push.flags.at[i] & CELL_SOLID) != 0u, lit = false;
  uvec3 blocks = push.grid.size / PATH_BLOCK, block = cell_at(push.grid, i) / PATH_BLOCK;
  uint number = block.x + blocks.x * (block.y + blocks.y * block.z), all = blocks.x * blocks.y * blocks.z;
  for (uint c = 0u; c < 3u; ++c) {
    float entering = uintBitsToFloat(push.entering.at[c * count + i]);
    bool here = solid && entering > 0.0;
    push.paths.at[c * count + i] = here ? -log(entering) : PATH_FAR;
    if (!here) continue;
    lit = true;
    uint item = number + c * all;
    if (atomicOr(push.wanted.at[item], 1u << PATH_SELF) != 0u) continue;
    push.list.at[atomicAdd(push.groups.at[0], 1u)] = item;
  }
  if (lit) atomicAdd(push.counts.at[1], 1u);
}
