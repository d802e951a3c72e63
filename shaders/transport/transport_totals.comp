#version 460
#extension GL_GOOGLE_include_directive : require
#include "transport/transport_shared.h"
#include "shared/stride.glsl"
#include "shared/reduce.glsl"

// Power that the field scatters for the first time, what is absorbed of its fluence, and what that loses in all.
struct TransportTotalsPush {
  Vec3s vertices;
  Uvec4s tets;
  Opticals optical;
  Vec3s fluence;  // at the vertices
  Vec3s source;   // light that is scattered, four per tet, W/mm^3
  TransportBooks books;
  Reduction reduction;
  uint count;
  uint even;  // 1: optical is the same everywhere
  uint lost;  // 1: what is lost, 0: the others
};
layout(push_constant, scalar) uniform Block { TransportTotalsPush push; };

void main() {
  vec3 first = vec3(0), lost = vec3(0);
  EACH(i, push.count) {
    uvec4 corners = push.tets.at[i];
    vec3 p = push.vertices.at[corners.x];
    vec3 e1 = push.vertices.at[corners.y] - p, e2 = push.vertices.at[corners.z] - p;
    float quarter = abs(dot(e1, cross(e2, push.vertices.at[corners.w] - p))) / 24.0;
    Optical o = push.optical.at[push.even == 1u ? 0u : i];
    vec3 fluence = vec3(0), source = vec3(0);
    for (uint k = 0u; k < 4u; ++k) {
      fluence += push.fluence.at[corners[k]];
      source += push.source.at[4u * i + k];
    }
    vec3 scattered = quarter * o.sigma_s_prime * fluence;
    lost += quarter * o.sigma_a * fluence + (push.lost == 1u ? scattered : vec3(0));
    first += quarter * source - scattered;
  }
  vec3 all_first, all_lost;
  if (!reduce_dispatch_pair(push.reduction, first, lost, all_first, all_lost)) return;
  if (gl_LocalInvocationID.x != 0u) return;
  if (push.lost == 1u) {
    push.books.at[0].lost = all_lost;
    return;
  }
  push.books.at[0].first = all_first;
  push.books.at[0].absorbed = all_lost;
  // The sweep before is over.
  push.books.at[0].known_a = push.books.at[0].sum_a;
  push.books.at[0].known_b = push.books.at[0].sum_b;
  push.books.at[0].known_left = push.books.at[0].left;
  push.books.at[0].known_again = push.books.at[0].again;
}
