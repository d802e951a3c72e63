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

void main() {
  uint v = gl_GlobalInvocationID.x;
  if (v >= push.count) return;
  vec3 p = push.source.at[v];
  push.target.at[v] = push.record.kind == DEFORM_CAGE ? caged(p, v) : deformed_point(push.record, p, v);
}
