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
  vec3 uncollided;  // W/mm^2, fluence
};

Payload payload(uint id) {
  GatherPoint point = POINTS.at[id];
  return Payload(point, point.entry * exp(-point.depth));
}

#include "source/tet_ray.glsl"

const float FOUR_PI = 12.566371;

// The fields at barycentric coordinates `l` of the present tet.
Payload fields_at(vec4 l) {
  Payload p = corner_0.payload, q = corner_1.payload, r = corner_2.payload, s = corner_3.payload;
  GatherPoint a = p.point, b = q.point, c = r.point, d = s.point;
  return Payload(GatherPoint(l.x * a.phi + l.y * b.phi + l.z * c.phi + l.w * d.phi,
                             l.x * a.entry + l.y * b.entry + l.z * c.entry + l.w * d.entry,
                             l.x * a.depth + l.y * b.depth + l.z * c.depth + l.w * d.depth),
                 l.x * p.uncollided + l.y * q.uncollided + l.z * r.uncollided + l.w * s.uncollided);
}

Payload fields_here() {
  return fields_at(vec4(corner_0.l, corner_1.l, corner_2.l, corner_3.l));
}

// Of light that has not scattered, what is made of mean factors held to what is linear between the corners: as it is
// where that is more, and smoothly at most twice that. A corner that faint light reaches by a short way and one that
// bright light reaches by a long way would else make bright light of a short way between them.
vec3 held(vec3 uncollided, vec3 linear) {
  return mix(linear * (2.0 - linear / max(uncollided, vec3(1e-37))), uncollided, lessThanEqual(uncollided, linear));
}

// Fluence of both kinds between two points of a tet, weighed with exp(-tau s): the mean over s from 0 to 1.
vec3 fluence_along(Payload from_here, Payload to_there, vec3 tau, out vec3 lost) {
  GatherPoint from = from_here.point, to = to_there.point;
  vec3 growth = tau + to.depth - from.depth, unused;
  // Where light from behind outgrows the loss, integrate from the far end.
  bvec3 back = lessThan(growth, vec3(0));
  vec3 uncollided =
      attenuated_mean(mix(from.entry, to.entry, back), mix(to.entry, from.entry, back), abs(growth), unused);
  uncollided *= exp(max(-growth, vec3(0)) - from.depth);
  vec3 linear = attenuated_mean(from_here.uncollided, to_there.uncollided, tau, lost);
  return attenuated_mean(from.phi, to.phi, tau, lost) + held(uncollided, linear);
}

// Whether a ray may end that keeps `left` and has gathered `radiance`, of it `last` where it lost the share `lost`.
bool ends(vec3 left, vec3 radiance, vec3 last, vec3 lost) {
  vec3 behind = last * (1.0 - lost);
  return all(lessThanEqual(
      left, mix(vec3(GATHER_LEAST), vec3(GATHER_END), lessThanEqual(behind, GATHER_END * radiance * lost))));
}

// Radiance of a body that is everywhere as at a point.
vec3 even_radiance(Payload here) {
  vec3 albedo = min(optical.sigma_s_prime / max(extinction(), vec3(1e-30)), vec3(1));
  GatherPoint point = here.point;
  return albedo / FOUR_PI * (point.phi + held(point.entry * exp(-point.depth), here.uncollided));
}

#endif
