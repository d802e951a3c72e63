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
  float rays;  // per face
};
layout(push_constant, scalar) uniform Block { ExchangePush push; };

#include "shared/face_area.glsl"

float transmitted_by(uint face) {
  return refraction_behind(push.face_kinds, face).transmitted;
}

// W/mm^2 that a face sends out.
vec3 sent_by(uint face, vec3 clip) {
  return push.exitance.at[face] * clip + (1.0 - transmitted_by(face)) * push.before.at[face];
}

void main() {
  // W: received and sent by all, and of the former what enters beyond the share that enters of the first face's.
  mat3 sums = mat3(0.0);
  float first = transmitted_by(0u);
  EACH(f, push.count) {
    vec3 irradiance = vec3(0);
    if (is_open(push.face_kinds, f)) {
      vec3 clip = push.clip.at[0].factor;
      uvec2 row = push.rows.at[f];
      for (uint k = row.x; k < row.y; ++k) irradiance += sent_by(push.entries.at[k], clip);
      irradiance /= push.rays;
      float area = area_of(push.faces, push.vertices, f);
      sums[0] += area * irradiance;
      sums[1] += area * float(row.y - row.x) / push.rays * sent_by(f, clip);
      sums[2] += area * (transmitted_by(f) - first) * irradiance;
    }
    push.irradiance.at[f] = irradiance;
  }
  mat3 total;
  if (!reduce_dispatch_three(push.reduction, sums, total)) return;
  if (gl_LocalInvocationID.x != 0u) return;
  bvec3 any_light = greaterThan(total[0], vec3(0));
  vec3 transmitted = first + mix(vec3(0), total[2] / total[0], any_light);
  push.factor.at[0] = mix(vec3(0), total[1] / total[0], any_light);
  push.state.at[0].power = mix(vec3(0), transmitted * total[1], any_light);
  push.state.at[0].transmitted = transmitted;
}
