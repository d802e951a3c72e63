#version 460
#extension GL_GOOGLE_include_directive : require
#include "source/fixed_point.glsl"
#include "transport/transport_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// What samples have found of the flux, as loads on the vertices along x, y and z, and what is kept of those before.
struct TransportFluxLoadPush {
  Uints found;  // fixed point: for all vertices what is added along x, what is taken away, the same along y and z
  Vec3s load;   // those before, which the present ones replace
  Vec3s unit;   // one: the scale that these have
  Scales scale;
  uint vertex_count;
  float share;  // of what was found that counts
  float keep;   // of the loads before
};
layout(push_constant, scalar) uniform Block { TransportFluxLoadPush push; };

#include "transport/kept.glsl"

void main() {
  uint i = gl_GlobalInvocationID.x, count = push.vertex_count;
  if (i >= 3u * count) return;
  uint at = i + i / count * count;
  vec3 found = power_at(push.found, at) - power_at(push.found, at + count);
  push.load.at[i] = kept(push.load.at[i]) + push.share * found;
}
