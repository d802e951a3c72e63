#version 460
#extension GL_GOOGLE_include_directive : require
#include "solve_shared.h"
#define REDUCE(a, b) max(a, b)
#define REDUCE_ZERO vec3(0)
#include "reduce.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { IrradianceScalePush push; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  vec3 largest;
  if (!reduce_dispatch(push.reduction, i < push.count ? push.q.at[i] : vec3(0), largest)) return;
  if (gl_LocalInvocationID.x != 0u) return;
  vec3 any_channel = vec3(max(largest.x, max(largest.y, largest.z)));
  largest = mix(any_channel, largest, greaterThan(largest, vec3(0)));
  ivec3 exponent;
  frexp(largest, exponent);
  exponent = clamp(exponent, ivec3(-126), ivec3(126));
  push.scale.at[0].scale = ldexp(vec3(1), exponent);
  push.scale.at[0].inverse = ldexp(vec3(1), -exponent);
}
