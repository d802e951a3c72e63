#version 460
#extension GL_GOOGLE_include_directive : require
#include "solve_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { FaceExitancePush push; };

void main() {
  uint f = gl_GlobalInvocationID.x;
  if (f >= push.count || push.face_kinds.at[f] != FACE_OPEN) return;
  uvec3 corners = push.faces.at[f];
  push.exitance.at[f] = (push.vertex_exitance.at[corners.x] + push.vertex_exitance.at[corners.y] +
                         push.vertex_exitance.at[corners.z]) / 3.0;
}
