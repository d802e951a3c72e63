#version 460
#extension GL_GOOGLE_include_directive : require
#include "deform/deform.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// target[v] = source[v], moved. They may be the same.
struct DeformPush {
  DeformRecord record;
  Vec3s source;  // mm
  Vec3s target;  // mm
  uint count;
};
layout(push_constant, scalar) uniform Block { DeformPush push; };

// Weights belong to the vertices at rest, whatever has moved them since.
vec3 caged(vec3 p, uint vertex) {
  for (uint k = 0u; k < push.record.count; ++k) {
    p += push.record.weight.at[k * push.count + vertex] * push.record.control.at[k];
  }
  return p;
}

// Each body by its own rows.
vec3 placed(vec3 p, uint vertex) {
  uint first = 4u * uint(push.record.weight.at[vertex]);
  vec3 a = push.record.control.at[first], b = push.record.control.at[first + 1u], c = push.record.control.at[first + 2u];
  return vec3(dot(a, p), dot(b, p), dot(c, p)) + push.record.control.at[first + 3u];
}

vec3 moved(vec3 p, uint vertex) {
  if (push.record.kind == DEFORM_CAGE) return caged(p, vertex);
  if (push.record.kind == DEFORM_PLACED) return placed(p, vertex);
  return deformed_point(push.record, p, vertex);
}

void main() {
  uint v = gl_GlobalInvocationID.x;
  if (v >= push.count) return;
  push.target.at[v] = moved(push.source.at[v], v);
}
