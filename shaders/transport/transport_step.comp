#version 460
#extension GL_GOOGLE_include_directive : require
#include "transport/transport_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// Fluence at the vertices after a sweep: by the transport equation, and what that has changed once it has scattered on.
struct TransportStepPush {
  Vec3s vertices;
  Uvec4s tets;
  Opticals optical;
  Uints tet_offset;  // tets around each vertex
  Uints tet_incidence;
  Vec3s load_a;  // b of both halves
  Vec3s load_b;
  Vec3s change_a;  // what the solves made of them
  Vec3s change_b;
  Vec3s fluence;
  uint count;
  uint even;  // 1: optical is the same everywhere
};
layout(push_constant, scalar) uniform Block { TransportStepPush push; };

void main() {
  uint v = gl_GlobalInvocationID.x;
  if (v >= push.count) return;
  vec3 scattering = vec3(0);  // integral of sigma_s' times the basis function, mm^2
  for (uint k = push.tet_offset.at[v]; k < push.tet_offset.at[v + 1u]; ++k) {
    uint tet = push.tet_incidence.at[k];
    uvec4 corners = push.tets.at[tet];
    vec3 p = push.vertices.at[corners.x];
    vec3 e1 = push.vertices.at[corners.y] - p, e2 = push.vertices.at[corners.z] - p;
    float volume = abs(dot(e1, cross(e2, push.vertices.at[corners.w] - p))) / 6.0;
    scattering += 0.25 * volume * push.optical.at[push.even == 1u ? 0u : tet].sigma_s_prime;
  }
  vec3 load = 0.5 * (push.load_a.at[v] + push.load_b.at[v]);
  vec3 swept = mix(load / scattering, vec3(0), equal(scattering, vec3(0)));
  push.fluence.at[v] += swept + 0.5 * (push.change_a.at[v] + push.change_b.at[v]);
}
