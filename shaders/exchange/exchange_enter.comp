#version 460
#extension GL_GOOGLE_include_directive : require
#include "exchange/exchange_shared.h"
#include "shared/reduce.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { ExchangeEnterPush push; };

#include "shared/face_area.glsl"

void main() {
  uint f = gl_GlobalInvocationID.x;
  vec3 change = vec3(0), entered = vec3(0);
  if (f < push.count) {
    vec3 irradiance = load_vec3(push.factor, 0u) * load_vec3(push.irradiance, f);
    push.irradiance.at[f] = irradiance;
    vec3 q = push.transmitted * irradiance;
    float area = area_of(push.faces, push.vertices, f);
    entered = area * load_vec3(push.q, f);
    change = area * abs(q - load_vec3(push.beam_q, f));
    push.beam_q.at[f] = q;
  }
  vec3 total_change, total_entered;
  if (!reduce_dispatch_pair(push.reduction, change, entered, total_change, total_entered)) return;
  if (gl_LocalInvocationID.x != 0u) return;
  push.state.at[0].change = total_change;
  push.state.at[0].entered = total_entered;
}
