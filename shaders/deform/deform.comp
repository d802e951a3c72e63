#version 460
#extension GL_GOOGLE_include_directive : require
#include "deform/deform.h"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { DeformPush push; };

// Weights belong to the vertices at rest, whatever has moved them since.
vec3 caged(vec3 p, uint vertex) {
  for (uint k = 0u; k < push.record.count; ++k) {
    p += load_float(push.record.weight, k * push.count + vertex) * load_vec3(push.record.control, k);
  }
  return p;
}

void main() {
  uint v = gl_GlobalInvocationID.x;
  if (v >= push.count) return;
  vec3 p = load_vec3(push.source, v);
  push.target.at[v] = push.record.kind == DEFORM_CAGE ? caged(p, v) : deformed_point(push.record, p, v);
}
