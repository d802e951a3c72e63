#version 460
#extension GL_GOOGLE_include_directive : require
#include "path/path_light_shared.h"
#include "light/shaped.glsl"

layout(push_constant, scalar) uniform Block { SurfacePathPush path_push; };
#define push path_push.surface
layout(location = 0) out vec3 position;  // mm
layout(location = 1) out vec3 normal;
layout(location = 2) out vec3 rest;  // mm, the position at rest

void main() {
  SurfaceScene scene = load_scene(push.scene);
  position = load_vec3(scene.vertices, gl_VertexIndex);
  rest = vec3(0);
  if (PLACED_ROUGHNESS) rest = load_vec3(push.rest, gl_VertexIndex);
  normal = load_vec3(scene.normals, gl_VertexIndex);
  gl_Position = scene.clip_from_world * vec4(position, 1.0);
}
