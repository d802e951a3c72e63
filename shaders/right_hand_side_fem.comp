#version 460
#extension GL_GOOGLE_include_directive : require
#include "assembly_shared.h"
#include "fields.glsl"
#include "reduce.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { RightHandSideFemPush push; };

// Integral of q against the basis function of surface vertex i: a third of each of its open faces.
vec3 surface_load(uint i) {
  vec3 sum = vec3(0);
  for (uint k = push.face_offset.at[i]; k < push.face_offset.at[i + 1u]; ++k) {
    uint face = push.face_incidence.at[k];
    uvec3 corners = push.faces.at[face];
    vec3 p = push.vertices.at[corners.x];
    float area = 0.5 * length(cross(push.vertices.at[corners.y] - p, push.vertices.at[corners.z] - p));
    sum += push.q.at[face] * push.scale.at[0].inverse * area;
  }
  return sum / 3.0;
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  vec3 square = vec3(0);
  if (i < push.count) {
    Field b = diffuse_source(push.boundary, i < push.surface_count ? surface_load(i) : vec3(0));
    push.b.at[i] = b;
    square = product(b, solved(push.diagonal.at[i], b));
  }
  vec3 norm;
  if (!reduce_dispatch(push.reduction, square, norm)) return;
  if (gl_LocalInvocationID.x == 0u) push.state.at[0].norm = norm;
}
