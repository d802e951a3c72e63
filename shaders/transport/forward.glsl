// What passes of light that scatters forwards read. The shader that includes it defines first
//   FORWARD  where the TransportForwardRef is
#ifndef QUADGRAPH_FORWARD_GLSL
#define QUADGRAPH_FORWARD_GLSL

#include "shared/forward_scattering.h"
#include "transport/first_scattered.glsl"
#include "transport/transport_shared.h"

#ifndef FORWARD
#error "forward.glsl: FORWARD is not defined"
#endif

Optical optical_of(uint tet) {
  return FORWARD.optical.at[FORWARD.even == 1u ? 0u : tet];
}

uint place_among(uvec4 corners, uint v) {
  return corners.x == v ? 0u : corners.y == v ? 1u : corners.z == v ? 2u : 3u;
}

// By channel.
mat3 scaled_by(vec3 by, mat3 flux) {
  return mat3(by * flux[0], by * flux[1], by * flux[2]);
}

// Power that a tet scatters for the first time times the mean direction of travel of the light that it was of.
mat3 first_towards(uint tet) {
  vec3 all = first_of(FORWARD.deposit, tet);
  mat3 towards;
  for (uint axis = 0u; axis < 3u; ++axis) towards[axis] = 2.0 * power_at(FORWARD.towards, 3u * tet + axis) - all;
  return towards;
}

// Power in fixed point below which its direction is rounding.
const float LEAST_DIRECTED = 1e3 * POWER_UNIT;

// The mean direction of so much power, which times that is `towards`.
mat3 directions_of(vec3 power, mat3 towards) {
  vec3 by = mix(1.0 / power, vec3(0), lessThan(power, vec3(LEAST_DIRECTED)));
  return scaled_by(by, towards);
}

// The flux of light at the vertices is three vectors over the channels for each, along x, y and z, one such field after
// the other. As columns: times a direction they are what goes that way.
mat3 flux_at(Vec3s flux, uint v) {
  uint count = FORWARD.vertex_count;
  return mat3(flux.at[v], flux.at[count + v], flux.at[2u * count + v]);
}

void set_flux(Vec3s flux, uint v, mat3 value) {
  for (uint axis = 0u; axis < 3u; ++axis) flux.at[axis * FORWARD.vertex_count + v] = value[axis];
}

#endif
