#version 460
#extension GL_GOOGLE_include_directive : require
#include "path/path_light_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;
#include "path/path_entering.glsl"
#include "path/path_tools.glsl"

// Light enters at the point of the cut that is nearest to the middle of the cell, where the cut goes through the body.
void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= cell_count(push.grid)) return;
  uint flags = push.flags.at[i];
  if ((flags & CELL_CUT) == 0u || (flags & CELL_INSIDE) == 0u) return;
  vec3 middle = middle_of(push.grid, cell_at(push.grid, i));
  PathTool tool = push.tools.at.at[nearest_tool(push.tools, middle)];
  vec3 outward = -tool_gradient(tool, middle);
  enter(i, entering_at(middle + tool_distance(tool, middle) * outward, outward));
}
