#version 460
#extension GL_GOOGLE_include_directive : require
#include "surface/surface_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { VertexExitancePush push; };

float twice_area_of(uint face) {
  uvec3 corners = load_uvec3(push.faces, face);
  vec3 p = load_vec3(push.vertices, corners.x);
  return length(cross(load_vec3(push.vertices, corners.y) - p, load_vec3(push.vertices, corners.z) - p));
}

// A value far below the arithmetic mean, or none at all, counts as this share of it: one clipped vertex must not darken
// all around it.
const float LEAST_SHARE = 1.0 / 16.0;

// exp of the mean of the logarithms.
vec3 geometric_mean(uint begin, uint end, float area, vec3 mean) {
  vec3 logarithm = vec3(0);
  for (uint k = begin; k < end; ++k) {
    uint face = load_uint(push.face_incidence, k);
    vec3 value = max(max(load_vec3(push.face_exitance, face), LEAST_SHARE * mean), vec3(1e-37));
    logarithm += twice_area_of(face) / area * log(value);
  }
  return mix(vec3(0), exp(logarithm), greaterThan(mean, vec3(0)));
}

void main() {
  uint v = gl_GlobalInvocationID.x;
  if (v >= push.count) return;
  uint begin = load_uint(push.face_offset, v), end = load_uint(push.face_offset, v + 1u);
  float area = 0.0;
  vec3 mean = vec3(0);
  for (uint k = begin; k < end; ++k) {
    uint face = load_uint(push.face_incidence, k);
    float size = twice_area_of(face);
    area += size;
    mean += size * load_vec3(push.face_exitance, face);
  }
  mean = area > 0.0 ? mean / area : vec3(0);
  push.exitance.at[v] = push.geometric == 1u ? geometric_mean(begin, end, area, mean) : mean;
}
