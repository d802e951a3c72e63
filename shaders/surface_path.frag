#version 460
#extension GL_GOOGLE_include_directive : require
#include "path_light_shared.h"
#include "lights.glsl"
#include "fresnel.glsl"

layout(push_constant, scalar) uniform Block { SurfacePathPush path_push; };
#define push path_push.surface
layout(location = 0) in vec3 position;  // mm
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 rest;  // mm, the position at rest
layout(location = 0) out vec4 scattered_coverage;  // W/(mm^2 sr), 1
layout(location = 1) out vec4 specular;            // W/(mm^2 sr), 1
layout(location = 2) out vec4 unscattered;         // none, 1

SurfaceScene scene;
#include "environment.glsl"
#include "path_field.glsl"
#include "specular.glsl"

// Open surfaces are seen from both sides.
void main() {
  scene = load_scene(push.scene);
  place_roughness(rest);
  vec3 v = normalize(scene.eye - position);
  vec3 n = normalize(normal);
  if (dot(n, v) < 0.0) n = gl_FrontFacing ? normalize(n - 1.001 * dot(n, v) * v) : -n;
  float share = fresnel_transmittance(clamp(dot(n, v), 0.0, 1.0), scene.eta) / scene.radiance_norm;
  vec3 exitance = path_exitance(load_path_field(path_push.field), position);
  scattered_coverage = vec4(share * exitance, 1.0);
  specular = vec4(specular_radiance(position, n, v, 1.0), 1.0);
  unscattered = vec4(0.0, 0.0, 0.0, 1.0);
}
