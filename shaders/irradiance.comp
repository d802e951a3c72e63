#version 460
#extension GL_GOOGLE_include_directive : require
#include "lights.glsl"
#include "fresnel.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { IrradiancePush push; };

// q at one point: sum over the lights of visibility * cos * E * F_t(cos, eta).
vec3 irradiance_at(vec3 position, vec3 normal) {
  vec3 q = vec3(0.0);
  for (uint i = 0u; i < push.light_count; ++i) {
    LightRecord light = push.lights.at[i];
    Incident incident = incident_light(light, position);
    float cos_i = min(dot(normal, incident.direction), 1.0);
    if (cos_i <= 0.0) continue;
    float visibility = light_visibility(light, push.views, position, normal, 0);
    q += visibility * cos_i * fresnel_transmittance(cos_i, push.eta) * incident.irradiance;
  }
  return q;
}

void main() {
  uint f = gl_GlobalInvocationID.x;
  if (f >= push.face_count) return;
  uvec3 face = push.faces.at[f];
  vec3 a = push.vertices.at[face.x];
  vec3 ab = push.vertices.at[face.y] - a;
  vec3 ac = push.vertices.at[face.z] - a;
  vec3 normal = normalize(cross(ab, ac));

  // Row i, column j: an upright triangle, and beside it an inverted one where the row has room.
  uint n = push.subdivision;
  float h = 1.0 / float(n);
  vec3 sum = vec3(0.0);
  for (uint i = 0u; i < n; ++i) {
    for (uint j = 0u; i + j < n; ++j) {
      vec3 corner = a + h * (float(i) * ab + float(j) * ac);
      sum += irradiance_at(corner + h / 3.0 * (ab + ac), normal);
      if (i + j + 1u < n) sum += irradiance_at(corner + 2.0 * h / 3.0 * (ab + ac), normal);
    }
  }
  push.q.at[f] = sum * (h * h);
}
