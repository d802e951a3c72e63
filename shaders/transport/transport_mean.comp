#version 460
#extension GL_GOOGLE_include_directive : require
#include "transport/transport_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// The mean of both halves of a field.
struct TransportMeanPush {
  Vec3s a;
  Vec3s b;
  Vec3s mean;
  uint count;
};
layout(push_constant, scalar) uniform Block { TransportMeanPush push; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i < push.count) push.mean.at[i] = 0.5 * (push.a.at[i] + push.b.at[i]);
}
