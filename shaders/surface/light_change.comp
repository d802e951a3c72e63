#version 460
#extension GL_GOOGLE_include_directive : require
#include "surface/surface_shared.h"
#include "shared/stride.glsl"
#include "shared/reduce.glsl"
#include "shared/face_area.glsl"

// How much of the light on the faces is the same as before.
struct LightChangePush {
  Vec3s vertices;
  Uvec3s faces;
  Vec3s q;         // W/mm^2
  Vec3s q_before;  // W/mm^2
  Vec3s overlap;   // one, written: over the area, of the light that both have, of what either has, channels together; area
  Reduction reduction;
  uint count;
};
layout(push_constant, scalar) uniform Block { LightChangePush push; };

void main() {
  vec3 sums = vec3(0);
  EACH(f, push.count) {
    vec3 now = push.q.at[f], before = push.q_before.at[f];
    vec3 both = min(now, before), either = max(now, before);
    float area = area_of(push.faces, push.vertices, f);
    sums += area * vec3(both.x + both.y + both.z, either.x + either.y + either.z, 1.0);
  }
  vec3 total;
  if (!reduce_dispatch(push.reduction, sums, total)) return;
  if (gl_LocalInvocationID.x == 0u) push.overlap.at[0] = total;
}
