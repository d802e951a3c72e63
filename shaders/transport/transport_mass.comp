#version 460
#extension GL_GOOGLE_include_directive : require
#include "transport/transport_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// The integral of sigma_s' times the basis function of every vertex, mm^2.
struct TransportMassPush {
  Vec3s vertices;
  Uvec4s tets;
  Opticals optical;
  Floats etendue;  // as of BodyRef
  Uints tet_offset;  // tets around each vertex
  Uints tet_incidence;
  Vec3s mass;
  uint count;
  uint even;  // 1: optical is the same everywhere
};
layout(push_constant, scalar) uniform Block { TransportMassPush push; };

void main() {
  uint v = gl_GlobalInvocationID.x;
  if (v >= push.count) return;
  vec3 mass = vec3(0);
  for (uint k = push.tet_offset.at[v]; k < push.tet_offset.at[v + 1u]; ++k) {
    uint tet = push.tet_incidence.at[k];
    uvec4 corners = push.tets.at[tet];
    vec3 p = push.vertices.at[corners.x];
    vec3 e1 = push.vertices.at[corners.y] - p, e2 = push.vertices.at[corners.z] - p;
    float six = number_or_one(push.etendue, tet) * abs(dot(e1, cross(e2, push.vertices.at[corners.w] - p)));
    mass += six / 24.0 * push.optical.at[push.even == 1u ? 0u : tet].sigma_s_prime;
  }
  push.mass.at[v] = mass;
}
