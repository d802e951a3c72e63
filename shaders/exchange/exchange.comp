#version 460
#extension GL_GOOGLE_include_directive : require
#include "exchange/exchange_shared.h"
#include "shared/stride.glsl"
#include "shared/reduce.glsl"

// Irradiance of every face from those its rays met, each of which sends M and reflects part of what it
// received before; and the factor with which all arrives that is sent towards other faces.
struct ExchangePush {
  Vec3s vertices;
  Uvec3s faces;
  Uints face_kinds;
  Uvec2s rows;  // per face: its entries are entry[rows.x] to entry[rows.y - 1]
  Uints entries;
  Vec3s exitance;  // without the factor of the clip
  Clips clip;
  Vec3s before;      // irradiance of the bounce before
  Vec3s irradiance;  // written, without the factor
  Vec3s factor;      // one, written
  ExchangeStates state;
  Reduction reduction;
  uint count;
  float rays;         // per face
  float transmitted;  // share of uniform illumination that enters
};
layout(push_constant, scalar) uniform Block { ExchangePush push; };

#include "shared/face_area.glsl"

// W/mm^2 that a face sends out.
vec3 sent_by(uint face, vec3 clip) {
  return push.exitance.at[face] * clip + (1.0 - push.transmitted) * push.before.at[face];
}

void main() {
  vec3 received = vec3(0), sent = vec3(0);  // W
  EACH(f, push.count) {
    vec3 irradiance = vec3(0);
    if (push.face_kinds.at[f] == FACE_OPEN) {
      vec3 clip = push.clip.at[0].factor;
      uvec2 row = push.rows.at[f];
      for (uint k = row.x; k < row.y; ++k) irradiance += sent_by(push.entries.at[k], clip);
      irradiance /= push.rays;
      float area = area_of(push.faces, push.vertices, f);
      received += area * irradiance;
      sent += area * float(row.y - row.x) / push.rays * sent_by(f, clip);
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
