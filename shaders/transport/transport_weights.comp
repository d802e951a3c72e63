#version 460
#extension GL_GOOGLE_include_directive : require
#include "transport/transport_shared.h"
#include "shared/stride.glsl"
#include "shared/reduce.glsl"

// How many points each tet is to have, as a weight, and the sum of all weights.
struct TransportWeightsPush {
  Vec3s vertices;
  Uvec4s tets;
  Opticals optical;
  Uints nearest;  // surface vertex of each vertex
  Vec2s weights;  // per tet: weight and volume, mm^3
  Floats total;   // one
  Reduction reduction;
  uint count;
  uint even;  // 1: optical is the same everywhere
};
layout(push_constant, scalar) uniform Block { TransportWeightsPush push; };

float distance_below(uint v) {
  return distance(push.vertices.at[v], push.vertices.at[push.nearest.at[v]]);
}

void main() {
  float sum = 0.0;
  EACH(i, push.count) {
    uvec4 corners = push.tets.at[i];
    vec3 p = push.vertices.at[corners.x];
    vec3 e1 = push.vertices.at[corners.y] - p, e2 = push.vertices.at[corners.z] - p;
    float volume = abs(dot(e1, cross(e2, push.vertices.at[corners.w] - p))) / 6.0;
    float below = 0.25 * (distance_below(corners.x) + distance_below(corners.y) + distance_below(corners.z) +
                          distance_below(corners.w));
    Optical o = push.optical.at[push.even == 1u ? 0u : i];
    vec3 seen = exp(-below * (o.sigma_s_prime + o.sigma_a));
    float weight = volume * ((seen.x + seen.y + seen.z) / 3.0 + TRANSPORT_FLOOR);
    push.weights.at[i] = vec2(weight, volume);
    sum += weight;
  }
  vec3 total;
  if (!reduce_dispatch(push.reduction, vec3(sum), total)) return;
  if (gl_LocalInvocationID.x == 0u) push.total.at[0] = total.x;
}
