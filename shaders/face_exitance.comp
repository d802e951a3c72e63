#version 460
#extension GL_GOOGLE_include_directive : require
#include "solve_shared.h"
#include "geometric_mean.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { FaceExitancePush push; };

void main() {
  uint f = gl_GlobalInvocationID.x;
  if (f >= push.count || push.face_kinds.at[f] != FACE_OPEN) return;
  uvec3 corners = push.faces.at[f];
  vec3 mean = vec3(0), logarithm = vec3(0);
  for (int k = 0; k < 3; ++k) mean += push.vertex_exitance.at[corners[k]] / 3.0;
  for (int k = 0; k < 3; ++k) logarithm += floored_log(push.vertex_exitance.at[corners[k]], mean) / 3.0;
  push.exitance.at[f] = from_log(logarithm, mean);
}
