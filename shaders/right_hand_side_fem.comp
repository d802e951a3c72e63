#version 460
#extension GL_GOOGLE_include_directive : require
#include "solve_shared.h"
#include "reduce.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { RightHandSideFemPush push; };

// Integral of Q / (2A) against the basis function of surface vertex i: a third of each of its faces.
vec3 surface_value(uint i) {
  vec3 sum = vec3(0);
  for (uint k = push.face_offset.at[i]; k < push.face_offset.at[i + 1u]; ++k) {
    uint face = push.face_incidence.at[k].x;
    uvec3 corners = push.faces.at[face];
    vec3 p = push.vertices.at[corners.x];
    float area = 0.5 * length(cross(push.vertices.at[corners.y] - p, push.vertices.at[corners.z] - p));
    sum += push.q.at[face] * push.scale.at[0].inverse * area;
  }
  return sum * (push.source / (6.0 * push.mismatch));
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  vec3 square = vec3(0);
  if (i < push.count) {
    vec3 b = i < push.surface_count ? surface_value(i) : vec3(0);
    push.b.at[i] = b;
    square = b * b / push.diagonal.at[i];
  }
  vec3 norm;
  if (!reduce_dispatch(push.reduction, square, norm)) return;
  if (gl_LocalInvocationID.x == 0u) push.state.at[0].norm = norm;
}
