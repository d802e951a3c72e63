#version 460
#extension GL_GOOGLE_include_directive : require
#include "transport/transport_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// Exitance per face after a sweep, J = G + k11 delta, the mean of both halves.
struct TransportFacesPush {
  Uvec3s faces;
  Uints face_kinds;
  Scales scale;
  Vec3s gathered;  // of transport_exitance.comp
  Vec3s change_a;  // fluence at the vertices that the solves of both halves add
  Vec3s change_b;
  Vec3s exitance;  // W/mm^2, written
  uint count;
  float k11;
};
layout(push_constant, scalar) uniform Block { TransportFacesPush push; };

void main() {
  uint f = gl_GlobalInvocationID.x;
  if (f >= push.count || push.face_kinds.at[f] != FACE_OPEN) return;
  uvec3 ids = push.faces.at[f];
  vec3 change = vec3(0);
  for (uint k = 0u; k < 3u; ++k) change += (push.change_a.at[ids[k]] + push.change_b.at[ids[k]]) / 3.0;
  vec3 both = push.gathered.at[f] + push.gathered.at[push.count + f] + push.k11 * change;
  push.exitance.at[f] = 0.5 * both * push.scale.at[0].scale;
}
