#version 460
#extension GL_GOOGLE_include_directive : require
#include "surface_shared.h"
#include "reduce.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { DisplayScalePush push; };

void main() {
  uint f = gl_GlobalInvocationID.x;
  vec3 solved = vec3(0), shown = vec3(0);  // integrals over the face, in units of the scale
  if (f < push.count && push.face_kinds.at[f] == FACE_OPEN) {
    uvec3 corners = push.faces.at[f];
    vec3 p = push.vertices.at[corners.x];
    float area = 0.5 * length(cross(push.vertices.at[corners.y] - p, push.vertices.at[corners.z] - p));
    vec3 weight = area * push.scale.at[0].inverse;
    solved = weight * push.exitance.at[f];
    for (int k = 0; k < 3; ++k) shown += weight / 3.0 * push.vertex_exitance.at[corners[k]];
  }
  vec3 total_solved, total_shown;
  if (!reduce_dispatch_pair(push.reduction, solved, shown, total_solved, total_shown)) return;
  if (gl_LocalInvocationID.x != 0u) return;
  push.factor.at[0] = mix(vec3(1), total_solved / total_shown, greaterThan(total_shown, vec3(0)));
}
