#version 460
#extension GL_GOOGLE_include_directive : require
#include "assembly_shared.h"
#include "reduce.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { IrradianceScalePush push; };

float area_of(uint face) {
  uvec3 corners = push.faces.at[face];
  vec3 p = push.vertices.at[corners.x];
  return 0.5 * length(cross(push.vertices.at[corners.y] - p, push.vertices.at[corners.z] - p));
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  vec3 power;
  if (!reduce_dispatch(push.reduction, i < push.count ? area_of(i) * push.q.at[i] : vec3(0), power)) return;
  if (gl_LocalInvocationID.x != 0u) return;
  vec3 any_channel = vec3(max(power.x, max(power.y, power.z)));
  power = mix(any_channel, power, greaterThan(power, vec3(0)));
  ivec3 exponent;
  frexp(power, exponent);
  exponent = clamp(exponent, ivec3(-126), ivec3(126));
  push.scale.at[0].scale = ldexp(vec3(1), exponent);
  push.scale.at[0].inverse = ldexp(vec3(1), -exponent);
}
