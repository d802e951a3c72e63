#version 460
#extension GL_GOOGLE_include_directive : require
#include "lights.glsl"
#include "fresnel.glsl"

layout(push_constant, scalar) uniform Block { SurfacePush push; };
layout(location = 0) in vec3 position;  // mm
layout(location = 1) in vec3 normal;
layout(location = 0) out vec4 scattered_coverage;  // W/(mm^2 sr), 1
layout(location = 1) out vec4 specular;            // W/(mm^2 sr), 1
layout(location = 2) out vec4 unscattered;         // W/(mm^2 sr), 1
layout(location = 3) out vec4 transmittance;       // share of what is behind, 1

BodyRef body;
#define BODY body
#define POINTS push.scene.at[0].points
#include "gather.glsl"
#include "specular.glsl"

// Barycentric coordinates of the point of a face that lies below or above `point`.
vec3 coordinates_in(uint face, vec3 point) {
  uvec3 ids = BODY.faces.at[face];
  vec3 a = BODY.vertices.at[ids.x];
  vec3 u = BODY.vertices.at[ids.y] - a, v = BODY.vertices.at[ids.z] - a, offset = point - a;
  vec3 normal = cross(u, v);
  float area = max(dot(normal, normal), 1e-30);
  float second = dot(cross(offset, v), normal) / area, third = dot(cross(u, offset), normal) / area;
  vec3 l = max(vec3(1.0 - second - third, second, third), vec3(0));
  return l / (l.x + l.y + l.z);
}

void main() {
  SurfaceScenes scene = push.scene;
  body = scene.at[0].body;
  vec3 n = normalize(normal);
  vec3 v = normalize(scene.at[0].eye - position);
  uint face = scene.at[0].triangle_face.at[gl_PrimitiveID];
  Gathered light =
      leaving(face, coordinates_in(face, position), v, n, scene.at[0].scale, scene.at[0].radiance_norm);
  vec3 behind = vec3(0.0);
  for (uint i = 0u; i < scene.at[0].light_count; ++i) {
    if (scene.at[0].lights.at[i].kind == LIGHT_AMBIENT) behind += scene.at[0].lights.at[i].power / PI;
  }
  scattered_coverage = vec4(light.radiance, 1.0);
  specular = vec4(specular_radiance(position, n, v), 1.0);
  unscattered = vec4(light.seen * behind, 1.0);
  transmittance = vec4(light.seen, 1.0);
}
