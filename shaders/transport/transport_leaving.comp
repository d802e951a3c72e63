#version 460
#extension GL_GOOGLE_include_directive : require
#include "transport/transport_shared.h"
#include "shared/stride.glsl"
#include "shared/reduce.glsl"
#include "shared/face_area.glsl"

// Power that leaves, as either half has gathered it.
struct TransportLeavingPush {
  Vec3s vertices;
  Uvec3s faces;
  Vec3s gathered;  // of transport_exitance.comp
  TransportBooks books;
  Reduction reduction;
  uint count;
};
layout(push_constant, scalar) uniform Block { TransportLeavingPush push; };

void main() {
  vec3 a = vec3(0), b = vec3(0);
  EACH(f, push.count) {
    float area = area_of(push.faces, push.vertices, f);
    a += area * push.gathered.at[f];
    b += area * push.gathered.at[push.count + f];
  }
  vec3 all_a, all_b;
  if (!reduce_dispatch_pair(push.reduction, a, b, all_a, all_b)) return;
  if (gl_LocalInvocationID.x != 0u) return;
  push.books.at[0].leaving_a = all_a;
  push.books.at[0].leaving_b = all_b;
}
