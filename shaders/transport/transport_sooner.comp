#version 460
#extension GL_GOOGLE_include_directive : require
#include "transport/transport_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// Light scatters sooner beside the forward peak than by the reduced coefficient: what the solve has as unscattered and
// rays do not is added to the fluence of what has scattered. In place of light that enters again, which
// transport_fluence.comp has added.
struct TransportSoonerPush {
  TransportForwardRefs forward;  // one
  Uints first;                   // fixed point, per vertex, by the solve: power of the scene's light scattered for the first time
  Uints all;                     // and with that of light that enters again
  Vec3s mass;                    // of transport_mass.comp
  Vec3s fluence;
  float share;  // of what is added
};
layout(push_constant, scalar) uniform Block { TransportSoonerPush push; };

TransportForwardRef forward;
#define FORWARD forward
#include "transport/forward.glsl"

void main() {
  uint v = gl_GlobalInvocationID.x;
  forward = push.forward.at[0];
  if (v >= forward.vertex_count) return;
  vec3 rays = vec3(0);
  for (uint k = forward.tet_offset.at[v]; k < forward.tet_offset.at[v + 1u]; ++k) {
    uint tet = forward.tet_incidence.at[k];
    rays += power_at(forward.deposit, 4u * tet + place_among(forward.tets.at[tet], v));
  }
  vec3 all = power_at(push.all, v), again = max(all - power_at(push.first, v), vec3(0)), mass = push.mass.at[v];
  vec3 more = beside_peak(forward.beside.g) * all - rays - again;
  push.fluence.at[v] += push.share * mix(more / mass, vec3(0), equal(mass, vec3(0)));
}
