#version 460
#extension GL_GOOGLE_include_directive : require
#include "path/path_shared.h"
#include "path/path_tools.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// Which cells are solid.
struct PathSolidPush {
  PathGrid grid;
  Uints votes;  // path_winding.comp's, axis after axis
  Uints flags;
  CoherentUints wanted;  // PathRelaxPush; 0 where a cell of the block is solid
  Uints counts;  // PathCounts
  PathTools tools;
};
layout(push_constant, scalar) uniform Block { PathSolidPush push; };

// By the majority of six directions, as winding numbers of broken surfaces are means over all (Jacobson et al. 2013).
bool inside(uint cell) {
  uint votes = 0u;
  for (uint axis = 0u; axis < 3u; ++axis) votes += push.votes.at[axis * cell_count(push.grid) + cell];
  return votes > 3u;
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= cell_count(push.grid)) return;
  uint flags = push.flags.at[i];
  if (inside(i)) flags |= CELL_INSIDE;
  vec3 middle = middle_of(push.grid, cell_at(push.grid, i));
  if (cut_away(push.tools, middle)) flags = 0u;
  if ((flags & (CELL_INSIDE | CELL_SURFACE)) == 0u) {
    push.flags.at[i] = 0u;
    return;
  }
  uint tool = nearest_tool(push.tools, middle);
  if (tool != NO_TOOL && tool_distance(push.tools.at.at[tool], middle) < push.grid.cell) flags |= CELL_CUT;
  push.flags.at[i] = flags | CELL_SOLID;
  atomicAdd(push.counts.at[0], 1u);
  uvec3 blocks = push.grid.size / PATH_BLOCK, block = cell_at(push.grid, i) / PATH_BLOCK;
  uint number = block.x + blocks.x * (block.y + blocks.y * block.z);
  for (uint c = 0u; c < 6u; ++c) push.wanted.at[number + c * blocks.x * blocks.y * blocks.z] = 0u;
}
