#version 460
#extension GL_GOOGLE_include_directive : require
#include "path/path_light_shared.h"

layout(push_constant, scalar) uniform Block { SurfacePathPush push; };
layout(location = 0) out vec3 position;  // mm
layout(location = 1) out vec3 normal;
layout(location = 2) out vec3 rest;  // mm, where the roughness lies
layout(location = 3) out vec3 shape;  // mm, the position at rest

#define SCENE push.scene.at[0]

void main() {
  position = SCENE.vertices.at[gl_VertexIndex];
  rest = shape = vec3(0);
  if (uvec2(SCENE.roughness_map.texels) != uvec2(0)) rest = SCENE.roughness_map.rest.at[gl_VertexIndex];
  if (uvec2(SCENE.normal_map.texels) != uvec2(0)) shape = SCENE.normal_map.rest.at[gl_VertexIndex];
  normal = SCENE.normals.at[gl_VertexIndex];
  gl_Position = SCENE.clip_from_offset * vec4(position - SCENE.origin, 1.0);
}
