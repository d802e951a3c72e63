#version 460
#extension GL_GOOGLE_include_directive : require
#include "gather_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { GatherScalePush push; };

void main() {
  uint v = gl_GlobalInvocationID.x;
  if (v >= push.count) return;
  float area = 0.0;
  vec3 gathered = vec3(0);
  for (uint k = push.face_offset.at[v]; k < push.face_offset.at[v + 1u]; ++k) {
    uint face = push.face_incidence.at[k];
    uvec3 ids = push.faces.at[face];
    vec3 p = push.vertices.at[ids.x];
    float size = length(cross(push.vertices.at[ids.y] - p, push.vertices.at[ids.z] - p));
    area += size;
    gathered += size * push.gathered.at[face];
  }
  gathered = area > 0.0 ? gathered / area : vec3(0);
  vec3 exitance = push.exitance.at[v];
  vec3 factor = mix(vec3(0), clamp(exitance / gathered, vec3(0), vec3(GATHER_FACTOR_MAX)),
                    greaterThan(gathered, vec3(0)));
  push.scale.at[v] = GatherScale(factor, max(exitance - factor * gathered, vec3(0)));
}
