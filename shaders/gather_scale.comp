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
  for (uint k = load_uint(push.face_offset, v); k < load_uint(push.face_offset, v + 1u); ++k) {
    uint face = load_uint(push.face_incidence, k);
    uvec3 ids = load_uvec3(push.faces, face);
    vec3 p = load_vec3(push.vertices, ids.x);
    float size = length(cross(load_vec3(push.vertices, ids.y) - p, load_vec3(push.vertices, ids.z) - p));
    area += size;
    gathered += size * load_vec3(push.gathered, face);
  }
  gathered = area > 0.0 ? gathered / area : vec3(0);
  vec3 exitance = load_vec3(push.exitance, v);
  vec3 factor = mix(vec3(0), clamp(exitance / gathered, vec3(0), vec3(GATHER_FACTOR_MAX)),
                    greaterThan(gathered, vec3(0)));
  push.scale.at[v] = GatherScale(factor, max(exitance - factor * gathered, vec3(0)));
}
