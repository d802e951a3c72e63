#version 460
#extension GL_GOOGLE_include_directive : require
#include "transport/transport_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// The flux of scattered light at the vertices. At the start that of the fluence and of what scatters for the first time,
// by P1, and what sweeps have added to that before; after a sweep what that has changed, and by P1 what the solves of both
// halves add.
struct TransportFluxPush {
  TransportForwardRefs forward;  // one
  Vec3s a;                       // fluence at the vertices, of which and of b half counts
  Vec3s b;
  Vec3s gain;   // one; or null: 1
  Vec3s swept;  // flux that the sweep has changed; null at the start
  Vec3s flux;   // written, or added to
  Vec3s added;  // by sweeps so far; at the start brought to the present scale
  Vec3s unit;   // one: the scale that it had
  Scales scale;
  float keep;  // at the start, of `added`: 1: all, 0: nothing
  float adds;  // after a sweep, 1: what it has changed counts among that, 0: it does not
};
layout(push_constant, scalar) uniform Block { TransportFluxPush push; };

TransportForwardRef forward;
#define FORWARD forward
#include "transport/forward.glsl"
#include "transport/kept.glsl"

vec3 fluence(uint v) {
  return 0.5 * element_or_one(push.gain, 0u) * (push.a.at[v] + push.b.at[v]);
}

bool starts() {
  return uvec2(push.swept) == uvec2(0);
}

// Flux of the fluence in a tet, times its volume and etendue; sigma: extinction less what scatters on, 1/mm. Nowhere
// more than the fluence itself.
mat3 flux_in(uint tet, vec3 sigma, out float volume) {
  uvec4 corners = forward.tets.at[tet];
  vec3 p = forward.vertices.at[corners.x], f = fluence(corners.x);
  vec3 e1 = forward.vertices.at[corners.y] - p, e2 = forward.vertices.at[corners.z] - p;
  vec3 e3 = forward.vertices.at[corners.w] - p;
  vec3 f1 = fluence(corners.y), f2 = fluence(corners.z), f3 = fluence(corners.w);
  float six = dot(e1, cross(e2, e3));
  volume = number_or_one(forward.etendue, tet) * abs(six) / 6.0;
  if (six == 0.0) return mat3(0.0);
  vec3 n1 = cross(e2, e3) / six, n2 = cross(e3, e1) / six, n3 = cross(e1, e2) / six;
  mat3 slope = outerProduct(f1 - f, n1) + outerProduct(f2 - f, n2) + outerProduct(f3 - f, n3);
  vec3 mean = 0.25 * abs(f + f1 + f2 + f3);
  vec3 steep = sqrt(slope[0] * slope[0] + slope[1] * slope[1] + slope[2] * slope[2]);
  return scaled_by(-volume / max(3.0 * sigma, steep / max(mean, vec3(1e-30)) + vec3(1e-20)), slope);
}

// By P1; at the start with what light does that scatters for the first time.
mat3 flux_around(uint v) {
  vec3 c = cosine_beside_peak(forward.beside.g);
  mat3 sum = mat3(0.0);
  float around = 0.0;
  for (uint k = forward.tet_offset.at[v]; k < forward.tet_offset.at[v + 1u]; ++k) {
    uint tet = forward.tet_incidence.at[k];
    Optical o = optical_of(tet);
    vec3 sigma = max(o.sigma_a + (1.0 - c) * o.sigma_s_prime, vec3(1e-20));
    float volume;
    sum += flux_in(tet, sigma, volume);
    around += volume;
    if (starts()) sum += scaled_by(c / sigma, first_towards(tet));
  }
  return around > 0.0 ? (1.0 / around) * sum : mat3(0.0);
}

void main() {
  uint v = gl_GlobalInvocationID.x;
  forward = push.forward.at[0];
  if (v >= forward.vertex_count) return;
  mat3 flux = flux_around(v), added = flux_at(push.added, v);
  if (starts()) {
    added = mat3(kept(added[0]), kept(added[1]), kept(added[2]));
    flux += added;
  } else {
    mat3 swept = flux_at(push.swept, v);
    added += push.adds * swept;
    flux += flux_at(push.flux, v) + swept;
  }
  set_flux(push.flux, v, flux);
  set_flux(push.added, v, added);
}
