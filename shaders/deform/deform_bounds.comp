#version 460
#extension GL_GOOGLE_include_directive : require
#include "deform/deform_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// One workgroup; the sphere around the middle of the bounding box, mm.
struct DeformBoundsPush {
  Vec3s vertices;
  Vec4s sphere;  // centre and radius, written
  uint count;
};
layout(push_constant, scalar) uniform Block { DeformBoundsPush push; };

shared vec3 low[WORKGROUP_SIZE], high[WORKGROUP_SIZE];

void combine(uint lane) {
  barrier();
  for (uint half_size = WORKGROUP_SIZE / 2u; half_size > 0u; half_size /= 2u) {
    if (lane < half_size) {
      low[lane] = min(low[lane], low[lane + half_size]);
      high[lane] = max(high[lane], high[lane + half_size]);
    }
    barrier();
  }
}

void main() {
  uint lane = gl_LocalInvocationID.x;
  vec3 least = vec3(1e37), most = vec3(-1e37);
  for (uint v = lane; v < push.count; v += WORKGROUP_SIZE) {
    vec3 p = push.vertices.at[v];
    least = min(least, p);
    most = max(most, p);
  }
  low[lane] = least;
  high[lane] = most;
  combine(lane);
  vec3 centre = 0.5 * (low[0] + high[0]);
  barrier();
  float radius = 0.0;
  for (uint v = lane; v < push.count; v += WORKGROUP_SIZE) {
    radius = max(radius, distance(push.vertices.at[v], centre));
  }
  low[lane] = high[lane] = vec3(radius);
  combine(lane);
  if (lane == 0u) push.sphere.at[0] = vec4(centre, high[0].x);
}
