#version 460
#extension GL_GOOGLE_include_directive : require
#include "transport/transport_shared.h"
#include "source/fixed_point.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// The linear function in each tet that has the integrals against its basis functions that the walk found.
struct TransportFirstPush {
  Vec3s vertices;
  Uvec4s tets;
  Uints deposit;  // fixed point, four per tet
  Vec3s first;
  uint count;
};
layout(push_constant, scalar) uniform Block { TransportFirstPush push; };

void main() {
  uint tet = gl_GlobalInvocationID.x;
  if (tet >= push.count) return;
  uvec4 corners = push.tets.at[tet];
  vec3 p = push.vertices.at[corners.x];
  vec3 e1 = push.vertices.at[corners.y] - p, e2 = push.vertices.at[corners.z] - p;
  float volume = abs(dot(e1, cross(e2, push.vertices.at[corners.w] - p))) / 6.0;
  vec3 power[4];
  vec3 sum = vec3(0);
  for (uint k = 0u; k < 4u; ++k) {
    power[k] = power_at(push.deposit, 4u * tet + k);
    sum += power[k];
  }
  for (uint k = 0u; k < 4u; ++k) {
    push.first.at[4u * tet + k] = volume > 0.0 ? 20.0 / volume * (power[k] - sum / 5.0) : vec3(0);
  }
}
