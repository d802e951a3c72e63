// What is cut away at a point.
#ifndef QUADGRAPH_PATH_TOOLS_GLSL
#define QUADGRAPH_PATH_TOOLS_GLSL

#include "path/path_tools.h"

const uint NO_TOOL = 0xffffffffu;

// The tool that a point is in or, if it is in none, the nearest; NO_TOOL without any.
uint nearest_tool(PathTools tools, vec3 p) {
  uint nearest = NO_TOOL;
  float least = 1e30;
  for (uint k = 0u; k < tools.count; ++k) {
    float distance = tool_distance(tools.at.at[k], p);
    if (distance < least) {
      least = distance;
      nearest = k;
    }
  }
  return nearest;
}

bool cut_away(PathTools tools, vec3 p) {
  for (uint k = 0u; k < tools.count; ++k) {
    if (tool_distance(tools.at.at[k], p) < 0.0) return true;
  }
  return false;
}

#endif
