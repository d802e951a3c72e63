// The fields of gathered radiance along a ray; see tet_ray.glsl. The shader that includes it
// defines first BODY (tet_ray.glsl) and
//   POINTS  where the GatherPoints are, e.g. push.points
#ifndef QUADGRAPH_GATHER_FIELDS_GLSL
#define QUADGRAPH_GATHER_FIELDS_GLSL

#include "gather/gather_shared.h"

#ifndef POINTS
#error "gather_fields.glsl: POINTS is not defined"
#endif

struct Payload {
  GatherPoint point;
};

Payload payload(uint id) {
  return Payload(POINTS.at[id]);
}

#include "source/tet_ray.glsl"

const float FOUR_PI = 12.566371;

// The fields at barycentric coordinates `l` of the present tet.
GatherPoint fields_at(vec4 l) {
  GatherPoint a = corner_0.payload.point, b = corner_1.payload.point, c = corner_2.payload.point,
              d = corner_3.payload.point;
  return GatherPoint(l.x * a.phi + l.y * b.phi + l.z * c.phi + l.w * d.phi,
                     l.x * a.entry + l.y * b.entry + l.z * c.entry + l.w * d.entry,
                     l.x * a.depth + l.y * b.depth + l.z * c.depth + l.w * d.depth);
}

GatherPoint fields_here() {
  return fields_at(vec4(corner_0.l, corner_1.l, corner_2.l, corner_3.l));
}

// Fluence of both kinds between two points of a tet, weighed with exp(-tau s): the mean over s from 0 to 1.
vec3 fluence_along(GatherPoint from, GatherPoint to, vec3 tau, out vec3 lost) {
  vec3 growth = tau + to.depth - from.depth, unused;
  // Where light from behind outgrows the loss, integrate from the far end.
  bvec3 back = lessThan(growth, vec3(0));
  vec3 uncollided =
      attenuated_mean(mix(from.entry, to.entry, back), mix(to.entry, from.entry, back), abs(growth), unused);
  return attenuated_mean(from.phi, to.phi, tau, lost) + uncollided * exp(max(-growth, vec3(0)) - from.depth);
}

// Whether a ray may end that keeps `left` and has gathered `radiance`, of it `last` where it lost the share `lost`.
bool ends(vec3 left, vec3 radiance, vec3 last, vec3 lost) {
  vec3 behind = last * (1.0 - lost);
  return all(lessThanEqual(
      left, mix(vec3(GATHER_LEAST), vec3(GATHER_END), lessThanEqual(behind, GATHER_END * radiance * lost))));
}

// Radiance of a body that is everywhere as at a point.
vec3 even_radiance(GatherPoint here) {
  vec3 albedo = min(optical.sigma_s_prime / max(extinction(), vec3(1e-30)), vec3(1));
  return albedo / FOUR_PI * (here.phi + here.entry * exp(-here.depth));
}

#endif
