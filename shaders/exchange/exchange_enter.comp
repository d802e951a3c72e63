#version 460
#extension GL_GOOGLE_include_directive : require
#include "exchange/exchange_shared.h"
#include "shared/stride.glsl"
#include "shared/reduce.glsl"

// Multiplies the irradiance by the factor; what of it enters becomes a beam.
struct ExchangeEnterPush {
  Vec3s vertices;
  Uvec3s faces;
  Uints face_kinds;
  Vec3s q;  // W/mm^2, of the scene's light
  Vec3s irradiance;
  Vec3s beam_q;  // of that beam, written
  Vec3s factor;  // one
  ExchangeStates state;
  Reduction reduction;
  uint count;
};
layout(push_constant, scalar) uniform Block { ExchangeEnterPush push; };

#include "shared/face_area.glsl"

void main() {
  vec3 change = vec3(0), entered = vec3(0);
  EACH(f, push.count) {
    vec3 irradiance = push.factor.at[0u] * push.irradiance.at[f];
    push.irradiance.at[f] = irradiance;
    vec3 q = refraction_behind(push.face_kinds, f).transmitted * irradiance;
    float area = area_of(push.faces, push.vertices, f);
    entered += area * push.q.at[f];
    change += area * abs(q - push.beam_q.at[f]);
    push.beam_q.at[f] = q;
  }
  vec3 total_change, total_entered;
  if (!reduce_dispatch_pair(push.reduction, change, entered, total_change, total_entered)) return;
  if (gl_LocalInvocationID.x != 0u) return;
  push.state.at[0].change = total_change;
  push.state.at[0].entered = total_entered;
}
