#version 460
#extension GL_GOOGLE_include_directive : require
#include "exchange/exchange_shared.h"
#include "shared/reduce.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { ExchangePush push; };

#include "shared/face_area.glsl"

// W/mm^2 that a face sends out.
vec3 sent_by(uint face, vec3 clip) {
  return load_vec3(push.exitance, face) * clip + (1.0 - push.transmitted) * load_vec3(push.before, face);
}

void main() {
  uint f = gl_GlobalInvocationID.x;
  vec3 received = vec3(0), sent = vec3(0);  // W
  if (f < push.count) {
    vec3 irradiance = vec3(0);
    if (load_uint(push.face_kinds, f) == FACE_OPEN) {
      vec3 clip = push.clip.at[0].factor;
      uvec2 row = load_uvec2(push.rows, f);
      for (uint k = row.x; k < row.y; ++k) irradiance += sent_by(load_uint(push.entries, k), clip);
      irradiance /= push.rays;
      float area = area_of(push.faces, push.vertices, f);
      received = area * irradiance;
      sent = area * float(row.y - row.x) / push.rays * sent_by(f, clip);
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
