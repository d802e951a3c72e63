#version 460
#extension GL_GOOGLE_include_directive : require
#include "lights.glsl"
#include "fresnel.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { IrradiancePush push; };

// q of one light with a direction at one point, over its power: visibility * cos * E * F_t(cos, eta).
float share_at(LightRecord light, vec3 position, vec3 normal) {
  Incident incident = incident_light(light, position);
  float cos_i = min(dot(normal, incident.direction), 1.0);
  if (cos_i <= 0.0) return 0.0;
  float visibility = light_visibility(light, push.views, position, normal, 0);
  return visibility * cos_i * fresnel_transmittance(cos_i, push.eta) * incident.share;
}

// The quarter of a face that its point a + u ab + v ac lies in, away from their boundaries.
uint quarter_of(float u, float v) {
  return u + v < 0.5 ? 0u : u > 0.5 ? 1u : v > 0.5 ? 2u : 3u;
}

// The same on the quarters of the face a, a + ab, a + ac.
vec4 quarters_of(LightRecord light, vec3 a, vec3 ab, vec3 ac, vec3 normal) {
  vec4 quarter = vec4(0);
  uint n = push.subdivision;
  float h = 1.0 / float(n);
  // Row i, column j: an upright triangle, and beside it an inverted one where the row has room.
  for (uint i = 0u; i < n; ++i) {
    for (uint j = 0u; i + j < n; ++j) {
      for (uint inverted = 0u; inverted < (i + j + 1u < n ? 2u : 1u); ++inverted) {
        float u = h * (float(i) + (inverted == 1u ? 2.0 : 1.0) / 3.0);
        float v = h * (float(j) + (inverted == 1u ? 2.0 : 1.0) / 3.0);
        quarter[quarter_of(u, v)] +=
            float(FACE_QUARTERS) * h * h * share_at(light, a + u * ab + v * ac, normal);
      }
    }
  }
  return quarter;
}

void main() {
  uint f = gl_GlobalInvocationID.x;
  if (f >= push.face_count) return;
  uvec3 face = load_uvec3(push.faces, f);
  vec3 a = load_vec3(push.vertices, face.x);
  vec3 ab = load_vec3(push.vertices, face.y) - a;
  vec3 ac = load_vec3(push.vertices, face.z) - a;
  vec3 doubled = cross(ab, ac);
  vec3 normal = doubled / max(length(doubled), 1e-30);  // none of a face without area

  vec3 q = vec3(0);
  uint beam = 0u;  // of the light
  for (uint i = 0u; i < push.light_count; ++i) {
    LightRecord light = load_light(push.lights, i);
    if (light.kind == LIGHT_AMBIENT) {
      float share = load_float(push.sky, f) * push.diffuse_transmittance;
      push.beam_q.at[beam + f] = share;
      q += share * light.power;
      beam += BEAM_FACE * push.face_count;
      continue;
    }
    vec4 quarter = quarters_of(light, a, ab, ac, normal);
    for (uint k = 0u; k < FACE_QUARTERS; ++k) push.beam_q.at[beam + FACE_QUARTERS * f + k] = quarter[k];
    q += dot(quarter, vec4(0.25)) * light.power;
    beam += BEAM_QUARTERS * push.face_count;
  }
  push.q.at[f] = q;
}
