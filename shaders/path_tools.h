// What is cut away from a body that is shown by shortest paths: shapes in mm, by the same code on the GPU and on the
// host.
#ifndef QUADGRAPH_PATH_TOOLS_H
#define QUADGRAPH_PATH_TOOLS_H

#include "shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
using glm::abs;
using glm::dot;
using glm::max;
using glm::sqrt;
#endif

const uint TOOL_PLANE = 0u;   // all in front of it: dot(a, p) > b.x, a of unit length
const uint TOOL_SLAB = 1u;    // all within b.y of it
const uint TOOL_SPHERE = 2u;  // around a, of radius b.x
const uint TOOL_BOX = 3u;     // around a, b half its sides, along the axes

struct PathTool {
  uint kind;
  vec3 a;
  vec3 b;
};

#ifndef __cplusplus
QG_ARRAY(PathToolList, PathTool);
#endif

// mm, from its surface; below 0 within.
QG_INLINE float tool_distance(PathTool tool, vec3 p) {
  if (tool.kind == TOOL_PLANE) return tool.b.x - dot(tool.a, p);
  if (tool.kind == TOOL_SLAB) return abs(dot(tool.a, p) - tool.b.x) - tool.b.y;
  vec3 away = p - tool.a;
  if (tool.kind == TOOL_SPHERE) return sqrt(dot(away, away)) - tool.b.x;
  vec3 over = abs(away) - tool.b;
  return max(over.x, max(over.y, over.z));
}

// Of tool_distance: unit, out of the tool.
QG_INLINE vec3 tool_gradient(PathTool tool, vec3 p) {
  if (tool.kind == TOOL_PLANE) return -tool.a;
  if (tool.kind == TOOL_SLAB) return dot(tool.a, p) < tool.b.x ? -tool.a : tool.a;
  vec3 away = p - tool.a;
  if (tool.kind == TOOL_SPHERE) return away / max(sqrt(dot(away, away)), 1e-20f);
  vec3 over = abs(away) - tool.b;
  float most = max(over.x, max(over.y, over.z));
  if (over.x == most) return vec3(away.x < 0.0f ? -1.0f : 1.0f, 0.0f, 0.0f);
  if (over.y == most) return vec3(0.0f, away.y < 0.0f ? -1.0f : 1.0f, 0.0f);
  return vec3(0.0f, 0.0f, away.z < 0.0f ? -1.0f : 1.0f);
}

// All that is cut away.
struct PathTools {
  QG_REF(PathToolList) at;
  uint count;
};

#ifdef __cplusplus
}  // namespace quadgraph::gpu
#endif
#endif
