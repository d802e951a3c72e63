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
  Floats etendue;  // as of BodyRef
  Uints nearest;        // surface vertex of each vertex
  Uints boundary;       // the same, or one of a surface that two bodies share, if that is nearer; null: none do
  Uints tet_offset;     // tets around each vertex
  Uints tet_incidence;
  Vec2s weights;  // per tet: weight, and volume times etendue, mm^3
  Floats total;   // one
  Reduction reduction;
  uint count;
  uint even;  // 1: optical is the same everywhere
};
layout(push_constant, scalar) uniform Block { TransportWeightsPush push; };

float distance_to(Uints nearest, uvec4 corners) {
  float sum = 0.0;
  for (uint k = 0u; k < 4u; ++k) {
    sum += distance(push.vertices.at[corners[k]], push.vertices.at[nearest.at[corners[k]]]);
  }
  return 0.25 * sum;
}

Optical optical_in(uint tet) {
  return push.optical.at[push.even == 1u ? 0u : tet];
}

float mean_of(vec3 v) {
  return (v.x + v.y + v.z) / 3.0;
}

// Points for each mm^3 of a tet, times a factor: the fewer the deeper it lies, in mean free paths. Bodies that share a
// surface are passed by the way out, and each in its own medium; what one of them scatters more than that at the surface,
// that much more its points count.
float points_in(uint tet, uvec4 corners) {
  Optical own = optical_in(tet);
  float below = distance_to(push.nearest, corners);
  if (push.even == 1u || uvec2(push.boundary) == uvec2(0)) {
    return mean_of(exp(-below * (own.sigma_s_prime + own.sigma_a))) + TRANSPORT_FLOOR;
  }
  float inside = min(distance_to(push.boundary, corners), below);
  Optical outer = optical_in(push.tet_incidence.at[push.tet_offset.at[push.nearest.at[corners.x]]]);
  vec3 depth = inside * (own.sigma_s_prime + own.sigma_a) + (below - inside) * (outer.sigma_s_prime + outer.sigma_a);
  float more = mean_of(own.sigma_s_prime) / max(mean_of(outer.sigma_s_prime), 1e-30);
  return clamp(more, 1.0 / TRANSPORT_DENSER, TRANSPORT_DENSER) * (mean_of(exp(-depth)) + TRANSPORT_FLOOR);
}

void main() {
  float sum = 0.0;
  EACH(i, push.count) {
    uvec4 corners = push.tets.at[i];
    vec3 p = push.vertices.at[corners.x];
    vec3 e1 = push.vertices.at[corners.y] - p, e2 = push.vertices.at[corners.z] - p;
    float six = number_or_one(push.etendue, i) * abs(dot(e1, cross(e2, push.vertices.at[corners.w] - p)));
    float volume = six / 6.0;
    float weight = volume * points_in(i, corners);
    push.weights.at[i] = vec2(weight, volume);
    sum += weight;
  }
  vec3 total;
  if (!reduce_dispatch(push.reduction, vec3(sum), total)) return;
  if (gl_LocalInvocationID.x == 0u) push.total.at[0] = total.x;
}
