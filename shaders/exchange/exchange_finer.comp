#version 460
#extension GL_GOOGLE_include_directive : require
#include "exchange/exchange_shared.h"
#include "shared/stride.glsl"
#include "shared/reduce.glsl"

// Irradiance of a level from the next coarser one, and the factor that keeps its power.
struct ExchangeFinerPush {
  Vec3s vertices;
  Uvec3s faces;
  Uints face_kinds;
  Uints index;
  Floats weight;
  Vec3s coarse;      // irradiance
  Vec3s irradiance;  // written, without the factor
  Vec3s factor;      // one, written
  ExchangeStates state;
  Reduction reduction;
  uint count;
  uint width;
};
layout(push_constant, scalar) uniform Block { ExchangeFinerPush push; };

#include "shared/face_area.glsl"

void main() {
  vec3 received = vec3(0);  // W
  EACH(f, push.count) {
    vec3 irradiance = vec3(0);
    if (is_open(push.face_kinds, f)) {
      for (uint k = f * push.width; k < (f + 1u) * push.width; ++k) {
        irradiance += push.weight.at[k] * push.coarse.at[push.index.at[k]];
      }
      received += area_of(push.faces, push.vertices, f) * irradiance;
    }
    push.irradiance.at[f] = irradiance;
  }
  vec3 total;
  if (!reduce_dispatch(push.reduction, received, total) || gl_LocalInvocationID.x != 0u) return;
  vec3 wanted = push.state.at[0].power / push.state.at[0].transmitted;
  push.factor.at[0] = mix(vec3(0), wanted / total, greaterThan(total, vec3(0)));
}
