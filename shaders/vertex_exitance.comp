#version 460
#extension GL_GOOGLE_include_directive : require
#include "solve_shared.h"
#include "geometric_mean.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { VertexExitancePush push; };

float twice_area_of(uint face) {
  uvec3 corners = push.faces.at[face];
  vec3 p = push.vertices.at[corners.x];
  return length(cross(push.vertices.at[corners.y] - p, push.vertices.at[corners.z] - p));
}

void main() {
  uint v = gl_GlobalInvocationID.x;
  if (v >= push.count) return;
  uint begin = push.face_offset.at[v], end = push.face_offset.at[v + 1u];
  float area = 0.0;
  vec3 mean = vec3(0), logarithm = vec3(0);
  for (uint k = begin; k < end; ++k) {
    uint face = push.face_incidence.at[k];
    float size = twice_area_of(face);
    area += size;
    mean += size * push.face_exitance.at[face];
  }
  mean = area > 0.0 ? mean / area : vec3(0);
  if (push.geometric == 1u) {
    for (uint k = begin; k < end; ++k) {
      uint face = push.face_incidence.at[k];
      logarithm += twice_area_of(face) / area * floored_log(push.face_exitance.at[face], mean);
    }
    mean = from_log(logarithm, mean);
  }
  push.exitance.at[v] = mean;
}
