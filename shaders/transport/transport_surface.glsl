// What the surface does to a ray of the transport correction. The shader that includes it defines first
//   FIELD  where the TransportFieldRef is
//   BODY   FIELD.body
// Where other parts of the body can be met outside, chance decides between the ways that a ray can take, each by its
// share of the power: so the ray keeps all of it and never divides. Elsewhere what leaves is gone.
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
  vec3 facet = facet_that_lets_in(incoming, by, surface, state);
  return refracted_by_facet(incoming, normal, facet, surface.eta);
}

// mm
vec3 in_space(TetPoint at) {
  uvec4 ids = BODY.tets.at[at.tet];
  return at.l.x * BODY.vertices.at[ids.x] + at.l.y * BODY.vertices.at[ids.y] + at.l.z * BODY.vertices.at[ids.z] +
         at.l.w * BODY.vertices.at[ids.w];
}

// From a point of `face` along `direction` through the air, past what only reflects it, until the ray enters the body
// again.
Entrance through_air(uint face, vec3 point, vec3 direction, inout uint state) {
  for (uint k = 0u; k < TRANSPORT_MEETINGS; ++k) {
    Hit hit = first_met(line_along(point, direction), face, FAR);
    if (hit.face == NO_FACE || !hit.outside) break;
    face = hit.face;
    point += hit.distance * direction;
    vec3 n = outward_normal(face);
    float cosine = clamp(-dot(direction, n), 0.0, 1.0);
    OpticalSurface surface = surface_of(BODY.face_kinds, face);
    if (is_open(BODY.face_kinds, face) && uniform_number(state) < surface_transmittance(cosine, surface)) {
      return Entrance(face, clamp(hit.place, vec2(0), vec2(1)), way_in(direction, n, n, surface, state));
    }
    direction = normalize(direction + 2.0 * cosine * n);
  }
  return Entrance(NO_FACE, vec2(0), direction);
}

#endif
