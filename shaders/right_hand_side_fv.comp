#version 460
#extension GL_GOOGLE_include_directive : require
#include "solve_shared.h"
#include "reduce.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { RightHandSideFvPush push; };

// area Q / (2A) at surface node `face`.
vec3 surface_value(uint face) {
  uvec3 corners = push.faces.at[face];
  vec3 p = push.vertices.at[corners.x];
  float area = 0.5 * length(cross(push.vertices.at[corners.y] - p, push.vertices.at[corners.z] - p));
  vec3 q = push.q.at[face] * push.scale.at[0].inverse;
  return q * (area * push.source / (2.0 * push.mismatch));
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  vec3 square = vec3(0);
  if (i < push.count) {
    vec3 b = i < push.tet_count ? vec3(0) : surface_value(i - push.tet_count);
    push.b.at[i] = b;
    square = b * b / push.diagonal.at[i];
  }
  vec3 norm;
  if (!reduce_dispatch(push.reduction, square, norm)) return;
  if (gl_LocalInvocationID.x == 0u) push.state.at[0].norm = norm;
}
