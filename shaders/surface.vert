#version 460
#extension GL_GOOGLE_include_directive : require
#include "render_shared.h"

layout(push_constant, scalar) uniform Block { SurfacePush push; };
layout(location = 0) out vec3 position;  // mm
layout(location = 1) out vec3 normal;
layout(location = 2) out vec3 exitance;              // W/mm^2
layout(location = 3) out vec3 unscattered_exitance;  // W/mm^2
layout(location = 4) out float sky;                  // share that is not hidden by the body

void main() {
  SurfaceScenes scene = push.scene;
  position = scene.at[0].vertices.at[gl_VertexIndex];
  normal = scene.at[0].normals.at[gl_VertexIndex];
  uint index = scene.at[0].face.at[gl_VertexIndex];
  uvec3 face = scene.at[0].faces.at[index];
  sky = scene.at[0].sky.at[index];
  vec3 weight = scene.at[0].barycentric.at[gl_VertexIndex];
  exitance = unscattered_exitance = vec3(0.0);
  for (int k = 0; k < 3; ++k) {
    exitance += weight[k] * scene.at[0].exitance.at[face[k]];
    unscattered_exitance += weight[k] * scene.at[0].unscattered.at[face[k]];
  }
  gl_Position = scene.at[0].clip_from_world * vec4(position, 1.0);
}
