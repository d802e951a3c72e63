#version 460
#extension GL_GOOGLE_include_directive : require
#include "transport/transport_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// Fluence at the vertices after a sweep: by the transport equation, and what that has changed once it has scattered on.
struct TransportStepPush {
  Vec3s swept;
  Vec3s change_a;  // what the solves made of both halves
  Vec3s change_b;
  TransportBooks books;
  Vec3s fluence;
  Vec3s added;  // of all changes so far
  uint count;
  float adds;  // 1: this one counts among them, 0: it does not
};
layout(push_constant, scalar) uniform Block { TransportStepPush push; };

void main() {
  uint v = gl_GlobalInvocationID.x;
  if (v >= push.count) return;
  vec3 change = 0.5 * push.books.at[0].gain * (push.change_a.at[v] + push.change_b.at[v]);
  push.fluence.at[v] += push.swept.at[v] + change;
  push.added.at[v] += push.adds * change;
}
