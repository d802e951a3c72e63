#version 460
#extension GL_GOOGLE_include_directive : require
#include "solve_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { VertexExitancePush push; };

void main() {
  uint v = gl_GlobalInvocationID.x;
  if (v >= push.count) return;
  float area_sum = 0.0;
  vec3 q = vec3(0), phi = vec3(0);
  for (uint k = push.face_offset.at[v]; k < push.face_offset.at[v + 1u]; ++k) {
    uint face = push.face_incidence.at[k].x;
    uvec3 corners = push.faces.at[face];
    vec3 p = push.vertices.at[corners.x];
    float area = length(cross(push.vertices.at[corners.y] - p, push.vertices.at[corners.z] - p));
    area_sum += area;
    q += area * push.q.at[face];
    phi += area * push.phi_face.at[face];
  }
  phi = push.fem == 1u ? push.x.at[v] * push.scale.at[0].scale : phi / area_sum;
  push.exitance.at[v] = (phi - 2.0 * q / area_sum) / (2.0 * push.mismatch);
}
