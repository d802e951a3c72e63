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

void main() {
  SurfaceScene scene = load_scene(push.scene);
  position = load_vec3(scene.vertices, gl_VertexIndex);
  rest = vec3(0);
  if (PLACED_ROUGHNESS) rest = load_vec3(push.rest, gl_VertexIndex);
  normal = load_vec3(scene.normals, gl_VertexIndex);
  uint index = load_uint(scene.face, gl_VertexIndex);
  uvec3 face = load_uvec3(scene.faces, index);
  sky = load_float(scene.sky, index);
  vec3 weight = load_vec3(scene.barycentric, gl_VertexIndex);
  exitance = unscattered_exitance = vec3(0.0);
  for (int k = 0; k < 3; ++k) {
    exitance += weight[k] * load_vec3(scene.exitance, face[k]);
    unscattered_exitance += weight[k] * load_vec3(scene.unscattered, face[k]);
  }
  gl_Position = scene.clip_from_world * vec4(position, 1.0);
}
