#version 460
#extension GL_GOOGLE_include_directive : require
#include "light/render_shared.h"

layout(push_constant, scalar) uniform Block { ShadowPush push; };

void main() {
  gl_Position = push.clip_from_world * vec4(load_vec3(push.vertices, gl_VertexIndex), 1.0);
}
