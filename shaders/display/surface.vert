#version 460
#extension GL_GOOGLE_include_directive : require
#include "light/shaped.glsl"

layout(push_constant, scalar) uniform Block { SurfacePush push; };
layout(location = 0) out vec3 position;  // mm
layout(location = 1) out vec3 normal;
layout(location = 2) out vec3 exitance;              // W/mm^2
layout(location = 3) out vec3 unscattered_exitance;  // W/mm^2
layout(location = 4) out float sky;                  // share that is not hidden by the body
layout(location = 5) out vec3 rest;                  // mm, the position at rest
layout(location = 6) flat out uint face;             // outside face of level 0
layout(location = 7) out vec3 shape;  // mm, the position at rest

#define SCENE push.scene.at[0]

void main() {
  position = SCENE.vertices.at[gl_VertexIndex];
  rest = shape = vec3(0);
  if (PLACED_ROUGHNESS) rest = push.rest.at[gl_VertexIndex];
  if (NORMAL_MAP) shape = SCENE.normal_map.rest.at[gl_VertexIndex];
  normal = SCENE.normals.at[gl_VertexIndex];
  face = SCENE.face.at[gl_VertexIndex];
  uvec3 corners = SCENE.faces.at[face];
  sky = SCENE.sky.at[face];
  vec3 weight = SCENE.barycentric.at[gl_VertexIndex];
  exitance = unscattered_exitance = vec3(0.0);
  for (int k = 0; k < 3; ++k) {
    exitance += weight[k] * SCENE.exitance.at[corners[k]];
    unscattered_exitance += weight[k] * SCENE.unscattered.at[corners[k]];
  }
  gl_Position = SCENE.clip_from_offset * vec4(position - SCENE.origin, 1.0);
}
