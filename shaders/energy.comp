#version 460
#extension GL_GOOGLE_include_directive : require
#include "surface_shared.h"
#include "fields.glsl"
#include "reduce.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { EnergyPush push; };

vec3 absorbed(uint tet) {
  uvec4 corners = push.tets.at[tet];
  vec3 p = push.vertices.at[corners.x];
  vec3 e1 = push.vertices.at[corners.y] - p, e2 = push.vertices.at[corners.z] - p, e3 = push.vertices.at[corners.w] - p;
  float volume = abs(dot(e1, cross(e2, e3))) / 6.0;
  vec3 phi;
  if (push.fem == 1u) {
    phi = 0.25 * (push.x.at[corners.x].phi + push.x.at[corners.y].phi + push.x.at[corners.z].phi +
                  push.x.at[corners.w].phi);
  } else {
    phi = push.to_phi.at[tet] * push.x.at[tet].phi;
  }
  return push.optical.at[push.even == 1u ? 0u : tet].sigma_a * phi * push.scale.at[0].scale * volume;
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  EnergySums sums = EnergySums(vec3(0), vec3(0), vec3(0));
  if (i < push.tet_count) sums.absorbed = absorbed(i);
  if (i < push.face_count) {
    uvec3 corners = push.faces.at[i];
    vec3 p = push.vertices.at[corners.x];
    float area = 0.5 * length(cross(push.vertices.at[corners.y] - p, push.vertices.at[corners.z] - p));
    vec3 q = push.face_kinds.at[i] == FACE_OPEN ? push.q.at[i] : vec3(0);
    vec3 exitance = push.exitance.at[i] * push.clip.at[0].factor;
    push.exitance.at[i] = exitance;
    sums.entered = area * q;
    sums.exitance = area * exitance;
  }
  vec3 parts[3] = vec3[](sums.entered, sums.exitance, sums.absorbed);
  [[dont_unroll]] for (int k = 0; k < 3; ++k) parts[k] = reduce_workgroup(parts[k]);
  if (gl_LocalInvocationID.x == 0u) push.sums.at[gl_WorkGroupID.x] = EnergySums(parts[0], parts[1], parts[2]);
}
