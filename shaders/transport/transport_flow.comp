#version 460
#extension GL_GOOGLE_include_directive : require
#include "transport/transport_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// What tets scatter to one side, of the light that samples see (transport_source.comp).
struct TransportFlowPush {
  TransportForwardRefs forward;  // one
  Vec3s flux;
  Vec3s flux_before;   // that before, which the present one replaces
  Vec3s flux_seen;     // written
  Vec3s flows;         // written, as of TransportFieldRef
  Vec3s flows_before;  // those before but for the direction, which the present ones replace, 16 per tet
  Vec3s unit;          // one: the scale that these have
  Scales scale;
  float share;  // of the present field
  float keep;   // of that before
};
layout(push_constant, scalar) uniform Block { TransportFlowPush push; };

TransportForwardRef forward;
#define FORWARD forward
#include "transport/forward.glsl"
#include "transport/kept.glsl"

// Share of a number that is the same as before, but for rounding.
const float SAME = 1e-5;

mat3 kept_flux(mat3 known) {
  return mat3(kept(known[0]), kept(known[1]), kept(known[2]));
}

void see_flux(uint v) {
  mat3 present = flux_at(push.flux, v), before = kept_flux(flux_at(push.flux_before, v));
  set_flux(push.flux_before, v, present);
  set_flux(push.flux_seen, v, push.share * present - before);
}

// Number `which` of a tet; less of that before, unless next to nothing is left of it.
void see(uint tet, uint which, vec3 present) {
  uint at = FLOWS_DIRECTION * tet + which;
  vec3 seen = push.share * present - kept(push.flows_before.at[at]);
  push.flows_before.at[at] = present;
  push.flows.at[FLOWS * tet + which] = mix(seen, vec3(0), lessThan(abs(seen), SAME * abs(present)));
}

void see_tet(uint tet) {
  uvec4 corners = forward.tets.at[tet];
  Optical o = optical_of(tet);
  vec3 sum = first_of(forward.deposit, tet), c = 3.0 * cosine_beside_peak(forward.beside.g);
  mat3 directions = directions_of(sum, first_towards(tet));
  float per_volume = per_volume_of(number_or_one(forward.etendue, tet) * volume_of(forward.vertices, corners));
  for (uint k = 0u; k < 4u; ++k) {
    vec3 first = first_at(forward.deposit, tet, k, sum, per_volume);
    mat3 flow = scaled_by(c * o.sigma_s_prime, flux_at(push.flux, corners[k])) + scaled_by(c * first, directions);
    for (uint axis = 0u; axis < 3u; ++axis) see(tet, 3u * k + axis, flow[axis]);
    see(tet, FLOWS_FIRST + k, first);
  }
  for (uint axis = 0u; axis < 3u; ++axis) push.flows.at[FLOWS * tet + FLOWS_DIRECTION + axis] = directions[axis];
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  forward = push.forward.at[0];
  if (i < forward.vertex_count) see_flux(i);
  if (i < forward.tet_count) see_tet(i);
}
