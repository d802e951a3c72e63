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
layout(location = 5) out vec3 rest;       // mm, where the roughness lies
layout(location = 6) out vec3 shape;      // mm, the position at rest
layout(location = 7) flat out vec3 across;  // normal of the triangle, twice its area long, mm^2

#define SCENE push.scene.at[0]

void main() {
  uint vertex = SCENE.triangles.at[gl_VertexIndex];
  position = SCENE.vertices.at[vertex];
  rest = shape = vec3(0);
  if (PLACED_ROUGHNESS) rest = push.rest.at[vertex];
  if (NORMAL_MAP) shape = SCENE.normal_map.rest.at[vertex];
  normal = SCENE.normals.at[vertex];
  uint first = 3 * (gl_VertexIndex / 3);
  vec3 corner = SCENE.vertices.at[SCENE.triangles.at[first]];
  across = cross(SCENE.vertices.at[SCENE.triangles.at[first + 1]] - corner,
                 SCENE.vertices.at[SCENE.triangles.at[first + 2]] - corner);
  face = SCENE.triangle_face.at[gl_VertexIndex / 3];
  sky = SCENE.sky.at[SCENE.face.at[vertex]];
  gl_Position = SCENE.clip_from_offset * vec4(position - SCENE.origin, 1.0);
}
