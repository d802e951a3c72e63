#version 460
#extension GL_GOOGLE_include_directive : require
#include "light/render_shared.h"

layout(push_constant, scalar) uniform Block { SurfacePush push; };
#define SURFACE push
layout(location = 0) in vec3 position;  // mm
layout(location = 1) in vec3 normal;
layout(location = 4) in float sky;  // share that is not hidden by the body
layout(location = 5) in vec3 rest;  // mm, where the roughness lies
layout(location = 7) in vec3 shape;  // mm, the position at rest
layout(location = 6) flat in uint face;  // outside face of level 0, of the same body
layout(location = 2) in vec3 exitance;             // W/mm^2
layout(location = 3) in vec3 unscattered_exitance;  // W/mm^2
layout(location = 0) out vec4 scattered_coverage;  // W/(mm^2 sr), 1
layout(location = 1) out vec4 specular;            // W/(mm^2 sr), 1
layout(location = 2) out vec4 unscattered;         // W/(mm^2 sr), 1

#include "display/specular.glsl"
#include "display/shading_normal.glsl"

// Lambertian exitance behind a smooth surface: radiance depends on direction by Fresnel's transmittance alone.
void main() {
  roughness = SCENE.roughness;
  if (PLACED_ROUGHNESS) place_roughness(rest, dFdx(rest), dFdy(rest));
  Refraction body = refraction_behind(SCENE.face_kinds, face);
  eta = body.eta;
  vec3 n = normalize(normal), v = towards_eye(SCENE.eye, position);
  vec3 to_right = dFdx(position), to_below = dFdy(position);
  if (NORMAL_MAP) n = mapped_normal(n, shape, dFdx(shape), dFdy(shape), to_right, to_below);
  n = seen_normal(n, cross(to_right, to_below), v);
  evenly = rough_reflectance(body, dot(n, v), roughness);
  float share = fresnel_transmittance(clamp(dot(n, v), 0.0, 1.0), eta) / body.radiance_norm;
  scattered_coverage = vec4(exitance * share, 1.0);
  specular = vec4(specular_radiance(position, n, v, sky), 1.0);
  unscattered = vec4(unscattered_exitance * share, 1.0);
}
