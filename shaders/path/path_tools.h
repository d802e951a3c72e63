// What is cut away from a body that is shown by shortest paths: shapes in mm, by the same code on the GPU and on the
// host.
#ifndef QUADGRAPH_PATH_TOOLS_H
#define QUADGRAPH_PATH_TOOLS_H

#include "shared/shared.h"

#ifdef __cplusplus
namespace quadgraph::gpu {
using glm::abs;
using glm::dot;
using glm::max;
using glm::min;
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

// Gradient of tool_distance: unit, out of the tool.
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

// Between which shares of `way` from `start` on it is in the tool; the first is not below the second where it never is.
QG_INLINE vec2 tool_span(PathTool tool, vec3 start, vec3 way) {
  if (tool.kind == TOOL_SPHERE) {
    vec3 off = start - tool.a;
    float a = dot(way, way), b = dot(off, way), rest = b * b - a * (dot(off, off) - tool.b.x * tool.b.x);
    if (rest <= 0.0f) return vec2(0.0f);
    return vec2(-(sqrt(rest) + b) / a, (sqrt(rest) - b) / a);
  }
  // Between planes: one in front of it, two, or three pairs.
  bool box = tool.kind == TOOL_BOX;
  vec2 span = vec2(-1e30f, 1e30f);
  for (int axis = 0; axis < (box ? 3 : 1); ++axis) {
    float speed = box ? way[axis] : dot(tool.a, way);
    float place = box ? start[axis] - tool.a[axis] : dot(tool.a, start) - tool.b.x;
    float half_width = box ? tool.b[axis] : tool.b.y, inverse = abs(speed) > 1e-20f ? 1.0f / speed : 1e20f;
    vec2 here = speed > 0.0f ? vec2(-place * inverse, 1e30f) : vec2(-1e30f, -place * inverse);
    if (tool.kind != TOOL_PLANE) {
      float one = (half_width - place) * inverse, other = (-half_width - place) * inverse;
      here = vec2(min(one, other), max(one, other));
    }
    span = vec2(max(span.x, here.x), min(span.y, here.y));
  }
  return span;
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
