#version 460
#extension GL_GOOGLE_include_directive : require
#include "transport/transport_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// A field at the vertices, or a load over the mass, by the means of its linear function against the basis functions: what
// few points have found at one vertex alone is noise, which the next sweep would have to sample.
struct TransportSmoothPush {
  Vec3s vertices;
  Uvec4s tets;
  Uints tet_offset;  // tets around each vertex
  Uints tet_incidence;
  Vec3s mass;   // null: 1
  Vec3s from;
  Vec3s to;
  uint count;
};
layout(push_constant, scalar) uniform Block { TransportSmoothPush push; };

vec3 value(uint v) {
  vec3 mass = element_or_one(push.mass, v);
  return mix(push.from.at[v] / mass, vec3(0), equal(mass, vec3(0)));
}

void main() {
  uint v = gl_GlobalInvocationID.x;
  if (v >= push.count) return;
  vec3 own = value(v), sum = vec3(0);
  float around = 0.0;
  for (uint k = push.tet_offset.at[v]; k < push.tet_offset.at[v + 1u]; ++k) {
    uvec4 corners = push.tets.at[push.tet_incidence.at[k]];
    vec3 p = push.vertices.at[corners.x];
    vec3 e1 = push.vertices.at[corners.y] - p, e2 = push.vertices.at[corners.z] - p;
    float volume = abs(dot(e1, cross(e2, push.vertices.at[corners.w] - p)));
    around += volume;
    sum += 0.2 * volume * (value(corners.x) + value(corners.y) + value(corners.z) + value(corners.w) + own);
  }
  push.to.at[v] = around > 0.0 ? sum / around : own;
}
