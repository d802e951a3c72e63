#version 460
#extension GL_GOOGLE_include_directive : require
#include "exchange/exchange_shared.h"
#include "shared/reduce.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { ExchangeFinerPush push; };

#include "shared/face_area.glsl"

void main() {
  uint f = gl_GlobalInvocationID.x;
  vec3 received = vec3(0);  // W
  if (f < push.count) {
    vec3 irradiance = vec3(0);
    if (load_uint(push.face_kinds, f) == FACE_OPEN) {
      for (uint k = f * push.width; k < (f + 1u) * push.width; ++k) {
        irradiance += load_float(push.weight, k) * load_vec3(push.coarse, load_uint(push.index, k));
      }
      received = area_of(push.faces, push.vertices, f) * irradiance;
    }
    push.irradiance.at[f] = irradiance;
  }
  vec3 total;
  if (!reduce_dispatch(push.reduction, received, total) || gl_LocalInvocationID.x != 0u) return;
  vec3 wanted = push.state.at[0].power / push.transmitted;
  push.factor.at[0] = mix(vec3(0), wanted / total, greaterThan(total, vec3(0)));
}
