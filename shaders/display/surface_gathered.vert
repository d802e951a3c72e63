// Drawn without an index buffer, so that a triangle's number is known here: gl_PrimitiveID in a fragment shader would
// require the feature geometryShader of the device.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "light/shaped.glsl"

layout(push_constant, scalar) uniform Block { SurfacePush push; };
layout(location = 0) out vec3 position;  // mm
layout(location = 1) out vec3 normal;
layout(location = 2) flat out uint face;  // outside face of level 0
layout(location = 4) out float sky;       // share that is not hidden by the body
layout(location = 5) out vec3 rest;       // mm, the position at rest

#define SCENE push.scene.at[0]

void main() {
  uint vertex = SCENE.triangles.at[gl_VertexIndex];
  position = SCENE.vertices.at[vertex];
  rest = vec3(0);
  if (PLACED_ROUGHNESS) rest = push.rest.at[vertex];
  normal = SCENE.normals.at[vertex];
  face = SCENE.triangle_face.at[gl_VertexIndex / 3];
  sky = SCENE.sky.at[SCENE.face.at[vertex]];
  gl_Position = SCENE.clip_from_offset * vec4(position - SCENE.origin, 1.0);
}
