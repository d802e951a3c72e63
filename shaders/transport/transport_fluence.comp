#version 460
#extension GL_GOOGLE_include_directive : require
#include "transport/transport_shared.h"
#include "solver/fields.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// Fluence at the vertices, of a solution.
struct TransportFluencePush {
  Fields x;
  Vec3s to_phi;  // null: 1
  Vec3s fluence;
  uint count;
};
layout(push_constant, scalar) uniform Block { TransportFluencePush push; };

void main() {
  uint v = gl_GlobalInvocationID.x;
  if (v >= push.count) return;
  push.fluence.at[v] = element_or_one(push.to_phi, v) * push.x.at[v].phi;
}
