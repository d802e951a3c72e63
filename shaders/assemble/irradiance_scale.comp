#version 460
#extension GL_GOOGLE_include_directive : require
#include "assemble/assembly_shared.h"
#include "shared/stride.glsl"
#include "shared/reduce.glsl"

layout(push_constant, scalar) uniform Block { IrradianceScalePush push; };

float area_of(uint face) {
  if (load_uint(push.face_kinds, face) != FACE_OPEN) return 0.0;
  uvec3 corners = load_uvec3(push.faces, face);
  vec3 p = load_vec3(push.vertices, corners.x);
  return 0.5 * length(cross(load_vec3(push.vertices, corners.y) - p, load_vec3(push.vertices, corners.z) - p));
}

// Faces with less than this share of the mean irradiance count as unlit.
const float UNLIT = 0.1;

void main() {
  float own = 0.0;
  vec3 entering = vec3(0);
  EACH(i, push.count) {
    float face = area_of(i);
    own += face;
    entering += face * load_vec3(push.q, i);
  }
  vec3 power, area;
  if (!reduce_dispatch_pair(push.reduction, entering, vec3(own), power, area)) return;
  if (gl_LocalInvocationID.x != 0u) return;
  push.scale.at[0].unlit = UNLIT * (power.x + power.y + power.z) / area.x;
  vec3 any_channel = vec3(max(power.x, max(power.y, power.z)));
  power = mix(any_channel, power, greaterThan(power, vec3(0)));
  ivec3 exponent;
  frexp(power, exponent);
  exponent = clamp(exponent, ivec3(-126), ivec3(126));
  push.scale.at[0].scale = ldexp(vec3(1), exponent);
  push.scale.at[0].inverse = ldexp(vec3(1), -exponent);
}
