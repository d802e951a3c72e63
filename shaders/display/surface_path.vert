#version 460
#extension GL_GOOGLE_include_directive : require
#include "path/path_light_shared.h"
#include "light/shaped.glsl"

layout(push_constant, scalar) uniform Block { SurfacePathPush path_push; };
layout(location = 0) out vec3 position;  // mm
layout(location = 1) out vec3 normal;
layout(location = 2) out vec3 rest;  // mm, where the roughness lies
layout(location = 3) out vec3 shape;  // mm, the position at rest

#define SCENE path_push.surface.scene.at[0]

void main() {
  position = SCENE.vertices.at[gl_VertexIndex];
  rest = shape = vec3(0);
  if (PLACED_ROUGHNESS) rest = path_push.surface.rest.at[gl_VertexIndex];
  if (NORMAL_MAP) shape = SCENE.normal_map.rest.at[gl_VertexIndex];
  normal = SCENE.normals.at[gl_VertexIndex];
  gl_Position = SCENE.clip_from_offset * vec4(position - SCENE.origin, 1.0);
}
