#version 460
#extension GL_GOOGLE_include_directive : require
#include "light/render_shared.h"

// Depth of the display mesh.
struct ShadowPush {
  mat4 clip_from_world;
  Vec3s vertices;  // mm
};
layout(push_constant, scalar) uniform Block { ShadowPush push; };

void main() {
  gl_Position = push.clip_from_world * vec4(push.vertices.at[gl_VertexIndex], 1.0);
}
