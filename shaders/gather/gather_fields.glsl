// The fields of gathered radiance along a ray; see tet_ray.glsl. The shader that includes it
// defines first BODY (tet_ray.glsl) and
//   POINTS  where the GatherPoints are, e.g. push.points
#ifndef QUADGRAPH_GATHER_FIELDS_GLSL
#define QUADGRAPH_GATHER_FIELDS_GLSL

#include "gather/gather_shared.h"

#ifndef POINTS
#error "gather_fields.glsl: POINTS is not defined"
#endif

#include "source/tet_ray.glsl"

const float FOUR_PI = 12.566371;

// Light at a point of the ray.
struct LocalLight {
  vec3 phi, entry, depth;  // as GatherPoint
  vec3 uncollided;         // W/mm^2, linear between vertices
};

LocalLight fields_at(uint tet, vec4 l) {
  uvec4 ids = BODY.tets.at[tet];
  vec4 phi = vec4(0), entry = vec4(0), depth = vec4(0), uncollided = vec4(0);
  for (uint k = 0u; k < 4u; ++k) {
    phi += l[k] * POINTS.at[ids[k]].phi;
    entry += l[k] * POINTS.at[ids[k]].entry;
    depth += l[k] * POINTS.at[ids[k]].depth;
    uncollided += l[k] * POINTS.at[ids[k]].uncollided;
  }
  float basic = 1.0 / number_or_one(BODY.etendue, tet);
  return LocalLight(phi.xyz, basic * entry.xyz, depth.xyz, basic * uncollided.xyz);
}

// Of light that has not scattered, what is made of mean factors held to what is linear between the corners: as it is
// where that is more, and smoothly at most twice that. A corner that faint light reaches by a short way and one that
// bright light reaches by a long way would else make bright light of a short way between them.
vec3 held(vec3 uncollided, vec3 linear) {
  return mix(linear * (2.0 - linear / max(uncollided, vec3(1e-37))), uncollided, lessThanEqual(uncollided, linear));
}

// Fluence of both kinds between two points of a tet, weighed with exp(-tau s): the mean over s from 0 to 1.
vec3 fluence_along(LocalLight from, LocalLight to, vec3 tau, out vec3 lost) {
  vec3 growth = tau + to.depth - from.depth, unused;
  // Where light from behind outgrows the loss, integrate from the far end.
  bvec3 back = lessThan(growth, vec3(0));
  vec3 uncollided =
      attenuated_mean(mix(from.entry, to.entry, back), mix(to.entry, from.entry, back), abs(growth), unused);
  uncollided *= exp(max(-growth, vec3(0)) - from.depth);
  vec3 linear = attenuated_mean(from.uncollided, to.uncollided, tau, lost);
  return attenuated_mean(from.phi, to.phi, tau, lost) + held(uncollided, linear);
}

// Whether a ray may end that keeps `left` and has gathered `radiance`, of it `last` where it lost the share `lost`.
bool ends(vec3 left, vec3 radiance, vec3 last, vec3 lost) {
  vec3 behind = last * (1.0 - lost);
  return all(lessThanEqual(
      left, mix(vec3(GATHER_LEAST), vec3(GATHER_END), lessThanEqual(behind, GATHER_END * radiance * lost))));
}

// Radiance of a body that is everywhere as at a point.
vec3 even_radiance(uint tet, LocalLight here) {
  Optical optical = optical_in(tet);
  vec3 albedo = min(optical.sigma_s_prime / max(extinction(optical), vec3(1e-30)), vec3(1));
  return albedo / FOUR_PI * (here.phi + held(here.entry * exp(-here.depth), here.uncollided));
}

#endif
