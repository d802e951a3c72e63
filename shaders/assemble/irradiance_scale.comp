#version 460
#extension GL_GOOGLE_include_directive : require
#include "assemble/assembly_shared.h"
#include "shared/stride.glsl"
#include "shared/reduce.glsl"

// `scale` from the power that enters, per channel.
struct IrradianceScalePush {
  Vec3s vertices;
  Uvec3s faces;
  Uints face_kinds;
  Vec3s q;
  Scales scale;
  Reduction reduction;
  uint count;
};
layout(push_constant, scalar) uniform Block { IrradianceScalePush push; };

float area_of(uint face) {
  if (!is_open(push.face_kinds, face)) return 0.0;
  uvec3 corners = push.faces.at[face];
  vec3 p = push.vertices.at[corners.x];
  return 0.5 * length(cross(push.vertices.at[corners.y] - p, push.vertices.at[corners.z] - p));
}

// Faces with less than this share of the mean irradiance count as unlit.
const float UNLIT = 0.1;

void main() {
  float own = 0.0;
  vec3 entering = vec3(0);
  EACH(i, push.count) {
    float face = area_of(i);
    own += face;
    entering += face * push.q.at[i];
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
