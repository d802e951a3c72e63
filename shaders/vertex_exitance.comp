#version 460
#extension GL_GOOGLE_include_directive : require
#include "solve_shared.h"
#include "fields.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { VertexExitancePush push; };

void main() {
  uint v = gl_GlobalInvocationID.x;
  if (v >= push.count) return;
  float area_sum = 0.0;
  vec3 q = vec3(0), exitance = vec3(0);
  for (uint k = push.face_offset.at[v]; k < push.face_offset.at[v + 1u]; ++k) {
    uint face = push.face_incidence.at[k];
    uvec3 corners = push.faces.at[face];
    vec3 p = push.vertices.at[corners.x];
    float area = length(cross(push.vertices.at[corners.y] - p, push.vertices.at[corners.z] - p));
    area_sum += area;
    q += area * push.q.at[face];
    exitance += area * push.face_exitance.at[face];
  }
  if (area_sum == 0.0) {
    push.exitance.at[v] = vec3(0);
  } else if (push.fem == 0u) {
    push.exitance.at[v] = exitance / area_sum;
  } else {
    vec3 flux = outward_flux(push.boundary, push.x.at[v]) * push.scale.at[0].scale;
    push.exitance.at[v] = push.clipped == 1u ? max(flux, vec3(0)) * push.clip.at[0].factor
                                             : flux - push.boundary.reflected * q / area_sum;
  }
}
