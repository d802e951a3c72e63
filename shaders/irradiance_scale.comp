#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared.h"
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
  ivec3 exponent;
  frexp(largest, exponent);
  exponent = clamp(exponent, ivec3(-126), ivec3(126));
  bvec3 lit = greaterThan(largest, vec3(0));
  push.scale.at[0].scale = mix(vec3(1), ldexp(vec3(1), exponent), lit);
  push.scale.at[0].inverse = mix(vec3(1), ldexp(vec3(1), -exponent), lit);
}
