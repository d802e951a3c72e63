// Drawn without an index buffer, so that a triangle's number is known here: gl_PrimitiveID in a fragment shader would
// require the feature geometryShader of the device.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "light/render_shared.h"

layout(push_constant, scalar) uniform Block { VisibilityPush push; };
layout(location = 0) flat out uint number;  // 1 + the display triangle

#define SCENE push.scene.at[0]

void main() {
  number = 1u + uint(gl_VertexIndex) / 3u;
  vec3 position = SCENE.vertices.at[SCENE.triangles.at[gl_VertexIndex]];
  gl_Position = SCENE.clip_from_offset * vec4(position - SCENE.origin, 1.0);
}
