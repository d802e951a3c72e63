#version 460
#extension GL_GOOGLE_include_directive : require
#include "display/false_colour_shared.h"

layout(push_constant, scalar) uniform Block { FalseColourPush push; };
layout(location = 0) out vec3 position;  // mm
layout(location = 1) out vec3 barycentric;
layout(location = 2) out float value;
layout(location = 3) out flat uint flags;

void main() {
  FalseVertex vertex = push.vertices.at[gl_VertexIndex];
  position = vertex.position;
  barycentric = vec3(0);
  barycentric[gl_VertexIndex % 3] = 1.0;
  value = vertex.value;
  flags = vertex.flags;
  gl_Position = push.clip_from_offset * vec4(position - push.origin, 1.0);
}
