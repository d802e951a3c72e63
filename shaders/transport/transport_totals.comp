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
  Floats etendue;  // as of BodyRef
  Vec3s fluence;  // at the vertices
  Vec3s source;   // light that is scattered, four per tet, W/mm^3
  TransportBooks books;
  Reduction reduction;
  uint count;
  uint even;  // 1: optical is the same everywhere
};
layout(push_constant, scalar) uniform Block { TransportTotalsPush push; };

void main() {
  vec3 first = vec3(0), absorbed = vec3(0), scattered = vec3(0);
  EACH(i, push.count) {
    uvec4 corners = push.tets.at[i];
    vec3 p = push.vertices.at[corners.x];
    vec3 e1 = push.vertices.at[corners.y] - p, e2 = push.vertices.at[corners.z] - p;
    float six = number_or_one(push.etendue, i) * abs(dot(e1, cross(e2, push.vertices.at[corners.w] - p)));
    float quarter = six / 24.0;
    Optical o = push.optical.at[push.even == 1u ? 0u : i];
    vec3 fluence = vec3(0), source = vec3(0);
    for (uint k = 0u; k < 4u; ++k) {
      fluence += push.fluence.at[corners[k]];
      source += push.source.at[4u * i + k];
    }
    vec3 scatters = quarter * o.sigma_s_prime * fluence;
    scattered += scatters;
    absorbed += quarter * o.sigma_a * fluence;
    first += quarter * source - scatters;
  }
  mat3 all;
  if (!reduce_dispatch_three(push.reduction, mat3(first, absorbed, scattered), all)) return;
  if (gl_LocalInvocationID.x != 0u) return;
  push.books.at[0].first = all[0];
  push.books.at[0].absorbed = all[1];
  push.books.at[0].lost = all[1] + all[2];
  // The sweep before is over.
  push.books.at[0].known_a = push.books.at[0].sum_a;
  push.books.at[0].known_b = push.books.at[0].sum_b;
  push.books.at[0].known_left = push.books.at[0].left;
  push.books.at[0].known_again = push.books.at[0].again;
}
