#version 460
#extension GL_GOOGLE_include_directive : require
#include "exchange_shared.h"
#include "reduce.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { ExchangePush push; };

#include "face_area.glsl"

// W/mm^2 that a face sends out.
vec3 sent_by(uint face) {
  return push.exitance.at[face] * push.clip.at[0].factor + (1.0 - push.transmitted) * push.before.at[face];
}

void main() {
  uint f = gl_GlobalInvocationID.x;
  vec3 received = vec3(0), sent = vec3(0);  // W
  if (f < push.count) {
    vec3 irradiance = vec3(0);
    if (push.face_kinds.at[f] == FACE_OPEN) {
      uvec2 row = push.rows.at[f];
      for (uint k = row.x; k < row.y; ++k) irradiance += sent_by(push.entries.at[k]);
      irradiance /= push.rays;
      float area = area_of(f);
      received = area * irradiance;
      sent = area * float(row.y - row.x) / push.rays * sent_by(f);
    }
    push.irradiance.at[f] = irradiance;
  }
  vec3 total_received, total_sent;
  if (!reduce_dispatch_pair(push.reduction, received, sent, total_received, total_sent)) return;
  if (gl_LocalInvocationID.x != 0u) return;
  bvec3 any_light = greaterThan(total_received, vec3(0));
  push.factor.at[0] = mix(vec3(0), total_sent / total_received, any_light);
  push.state.at[0].power = mix(vec3(0), push.transmitted * total_sent, any_light);
}
