#version 460
#extension GL_GOOGLE_include_directive : require
#include "solve_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { ExitancePush push; };

void main() {
  uint f = gl_GlobalInvocationID.x;
  if (f >= push.count) return;
  vec3 phi;
  if (push.fem == 1u) {
    uvec3 corners = push.faces.at[f];
    phi = (push.x.at[corners.x] + push.x.at[corners.y] + push.x.at[corners.z]) / 3.0;
  } else {
    uint node = push.tet_count + f;
    phi = push.to_phi.at[node] * push.x.at[node];
  }
  phi *= push.scale.at[0].scale;
  push.phi.at[f] = phi;
  push.exitance.at[f] = (phi - 2.0 * push.q.at[f]) / (2.0 * push.mismatch);
}
