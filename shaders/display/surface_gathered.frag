#version 460
#extension GL_GOOGLE_include_directive : require
#include "light/render_shared.h"

layout(push_constant, scalar) uniform Block { SurfacePush push; };
#define SURFACE push
layout(location = 0) in vec3 position;  // mm
layout(location = 1) in vec3 normal;
layout(location = 2) flat in uint face;  // outside face of level 0
layout(location = 4) in float sky;  // share that is not hidden by the body
layout(location = 5) in vec3 rest;  // mm, where the roughness lies
layout(location = 6) in vec3 shape;  // mm, the position at rest
layout(location = 7) flat in vec3 across;  // normal of the triangle, mm^2
layout(location = 0) out vec4 position_roughness;  // mm, more than 0
layout(location = 1) out vec4 specular_face;      // W/(mm^2 sr), high half of the face
layout(location = 2) out vec4 normal_face;        // unit, low half of the face

#include "display/specular.glsl"
#include "display/shading_normal.glsl"

void main() {
  roughness = SCENE.roughness;
  if (PLACED_ROUGHNESS) place_roughness(rest, dFdx(rest), dFdy(rest));
  Refraction body = refraction_behind(SCENE.face_kinds, face);
  eta = body.eta;
  vec3 n = normalize(normal), v = towards_eye(SCENE.eye, position);
  if (NORMAL_MAP) n = mapped_normal(n, shape, dFdx(shape), dFdy(shape), dFdx(position), dFdy(position));
  n = seen_normal(n, across, v);
  evenly = rough_reflectance(body, dot(n, v), roughness);
  position_roughness = vec4(position, roughness);
  specular_face = vec4(specular_radiance(position, n, v, sky), face / FACE_HALF);
  normal_face = vec4(n, face % FACE_HALF);
}
