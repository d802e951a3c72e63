// What the surface does to a ray of the transport correction. The shader that includes it defines first
//   FIELD  where the TransportFieldRef is
//   BODY   FIELD.body
// Where other parts of the body can be met outside, chance decides between the ways that a ray can take, each by its
// share of the power: so the ray keeps all of it and never divides. Elsewhere what leaves is gone.
// Where it also defines
//   FACET_BY_FACET
// light from outside meets the facets of a rough surface one by one, in place of what is known of them all.
#ifndef QUADGRAPH_TRANSPORT_SURFACE_GLSL
#define QUADGRAPH_TRANSPORT_SURFACE_GLSL

#include "material/fresnel.glsl"
#include "material/rough_surface.glsl"
#include "source/inner_surface.glsl"
#include "source/lambertian.glsl"
#include "shared/random.glsl"
#include "transport/transport_shared.h"

#ifndef FIELD
#error "transport_surface.glsl: FIELD is not defined"
#endif

#define TREE FIELD.tree
#define TREE_BODY FIELD.body
#include "exchange/face_tree.glsl"

bool sees_body(uint face) {
  return FIELD.outside != 0u && FIELD.sky.at[face] < 1.0;
}

// Where a ray enters the body.
struct Entrance {
  uint face;  // or NO_FACE: nowhere
  vec2 place;  // barycentric coordinates of its second and third corner
  vec3 direction;  // inside
};

TetPoint entrance_point(Entrance entry) {
  vec3 l = vec3(max(1.0 - entry.place.x - entry.place.y, 0.0), entry.place);
  return start_on_face(BODY.face_tets.at[entry.face], BODY.faces.at[entry.face], l);
}

// Inside, of light along `incoming` that goes in at a face by facets about the normal `by`, by one of them.
vec3 way_in(vec3 incoming, vec3 normal, vec3 by, OpticalSurface surface, inout uint state) {
  vec3 way = incoming;
  bool found = surface.roughness > 0.0 && way_by_facets(false, true, by, surface, two_numbers(state), way, state);
  return into_face(found ? way : refracted(incoming, by, surface.eta), normal, by);
}

// mm
vec3 in_space(TetPoint at) {
  uvec4 ids = BODY.tets.at[at.tet];
  return at.l.x * BODY.vertices.at[ids.x] + at.l.y * BODY.vertices.at[ids.y] + at.l.z * BODY.vertices.at[ids.z] +
         at.l.w * BODY.vertices.at[ids.w];
}

// Turns light from outside into what goes on from a face of that normal; whether that goes in.
bool goes_in_at(uint face, vec3 n, inout vec3 direction, inout uint state) {
  if (!is_open(BODY.face_kinds, face)) {
    direction = normalize(direction + 2.0 * clamp(-dot(direction, n), 0.0, 1.0) * n);
    return false;
  }
  OpticalSurface surface = surface_of(BODY.face_kinds, face);
#ifdef FACET_BY_FACET
  if (surface.roughness > 0.0) return goes_through_facets(false, n, surface, two_numbers(state), direction, state);
#endif
  float cosine = clamp(-dot(direction, n), 0.0, 1.0);
  bool goes_in = uniform_number(state) < surface_transmittance(cosine, surface);
  direction = goes_in ? way_in(direction, n, n, surface, state) : normalize(direction + 2.0 * cosine * n);
  return goes_in;
}

// From a point of `face` along `direction` through the air, past what only reflects it, until the ray enters the body
// again.
Entrance through_air(uint face, vec3 point, vec3 direction, inout uint state) {
  for (uint k = 0u; k < TRANSPORT_MEETINGS; ++k) {
    Hit hit = first_met(line_along(point, direction), face, FAR);
    if (hit.face == NO_FACE || !hit.outside) break;
    face = hit.face;
    point += hit.distance * direction;
    if (goes_in_at(face, outward_normal(face), direction, state)) {
      return Entrance(face, clamp(hit.place, vec2(0), vec2(1)), direction);
    }
  }
  return Entrance(NO_FACE, vec2(0), direction);
}

#endif
