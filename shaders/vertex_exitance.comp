#version 460
#extension GL_GOOGLE_include_directive : require
#include "solve_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { VertexExitancePush push; };

void main() {
  uint v = gl_GlobalInvocationID.x;
  if (v >= push.count) return;
  float area_sum = 0.0;
  vec3 exitance = vec3(0);
  for (uint k = push.face_offset.at[v]; k < push.face_offset.at[v + 1u]; ++k) {
    uint face = push.face_incidence.at[k];
    uvec3 corners = push.faces.at[face];
    vec3 p = push.vertices.at[corners.x];
    float area = length(cross(push.vertices.at[corners.y] - p, push.vertices.at[corners.z] - p));
    area_sum += area;
    exitance += area * push.face_exitance.at[face];
  }
  vec3 factor = push.clip_factor == 1u ? push.clip.at[0].factor : vec3(1);
  push.exitance.at[v] = area_sum > 0.0 ? exitance * factor / area_sum : vec3(0);
}
