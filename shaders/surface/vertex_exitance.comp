#version 460
#extension GL_GOOGLE_include_directive : require
#include "surface/surface_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// The area-weighted mean over the open faces around every surface vertex, 0 without any.
struct VertexExitancePush {
  Floats face_area;
  Uints face_offset;
  Uints face_incidence;
  Vec3s face_exitance;
  Vec3s exitance;
  uint count;
  uint geometric;  // 1: geometric mean, 0: arithmetic
};
layout(push_constant, scalar) uniform Block { VertexExitancePush push; };

// A value far below the arithmetic mean, or none at all, counts as this share of it: one clipped vertex must not darken
// all around it.
const float LEAST_SHARE = 1.0 / 16.0;

// exp of the mean of the logarithms.
vec3 geometric_mean(uint begin, uint end, float area, vec3 mean) {
  vec3 logarithm = vec3(0);
  for (uint k = begin; k < end; ++k) {
    uint face = push.face_incidence.at[k];
    vec3 value = max(max(push.face_exitance.at[face], LEAST_SHARE * mean), vec3(1e-37));
    logarithm += push.face_area.at[face] / area * log(value);
  }
  return mix(vec3(0), exp(logarithm), greaterThan(mean, vec3(0)));
}

void main() {
  uint v = gl_GlobalInvocationID.x;
  if (v >= push.count) return;
  uint begin = push.face_offset.at[v], end = push.face_offset.at[v + 1u];
  float area = 0.0;
  vec3 mean = vec3(0);
  for (uint k = begin; k < end; ++k) {
    uint face = push.face_incidence.at[k];
    float size = push.face_area.at[face];
    area += size;
    mean += size * push.face_exitance.at[face];
  }
  mean = area > 0.0 ? mean / area : vec3(0);
  push.exitance.at[v] = push.geometric == 1u ? geometric_mean(begin, end, area, mean) : mean;
}
