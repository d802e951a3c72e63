#version 460
#extension GL_GOOGLE_include_directive : require
#include "lights.glsl"
#include "fresnel.glsl"

layout(push_constant, scalar) uniform Block { SurfacePush push; };
layout(location = 0) in vec3 position;  // mm
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 exitance;           // W/mm^2
layout(location = 0) out vec4 diffuse_coverage;  // W/(mm^2 sr), 1
layout(location = 1) out vec4 specular;          // W/(mm^2 sr), 1

const float PI = 3.14159265;

// Cook and Torrance 1982 with the GGX distribution and height-correlated Smith masking (Walter et al. 2007, Heitz 2014)
// and exact Fresnel reflectance: BRDF times the cosine of incidence, 1/sr.
float cook_torrance(vec3 n, vec3 v, vec3 l) {
  float n_l = dot(n, l), n_v = dot(n, v);
  if (n_l <= 0.0 || n_v <= 0.0) return 0.0;
  vec3 h = normalize(v + l);
  float alpha2 = push.scene.at[0].roughness * push.scene.at[0].roughness;
  float n_h = dot(n, h);
  float base = n_h * n_h * (alpha2 - 1.0) + 1.0;
  float distribution = alpha2 / (PI * base * base);
  float mask = n_v * sqrt(alpha2 + (1.0 - alpha2) * n_l * n_l) + n_l * sqrt(alpha2 + (1.0 - alpha2) * n_v * n_v);
  return distribution * fresnel_reflectance(min(dot(v, h), 1.0), push.scene.at[0].eta) * 0.5 * n_l / mask;
}

void main() {
  SurfaceScenes scene = push.scene;
  vec3 n = normalize(normal);
  vec3 v = normalize(scene.at[0].eye - position);
  float cos_o = clamp(dot(n, v), 0.0, 1.0);
  float transmittance = fresnel_transmittance(cos_o, scene.at[0].eta);
  diffuse_coverage = vec4(exitance * (transmittance / scene.at[0].radiance_norm), 1.0);

  vec3 sum = vec3(0.0);
  for (uint i = 0u; i < scene.at[0].light_count; ++i) {
    LightRecord light = scene.at[0].lights.at[i];
    if (light.kind == LIGHT_AMBIENT) {
      sum += fresnel_reflectance(cos_o, scene.at[0].eta) / PI * light.power;  // as of a smooth surface
      continue;
    }
    Incident incident = incident_light(light, position);
    float reflected = cook_torrance(n, v, incident.direction);
    if (reflected == 0.0) continue;
    sum += reflected * light_visibility(light, scene.at[0].views, position, n, 1) * incident.irradiance;
  }
  specular = vec4(sum, 1.0);
}
