// The light of a beam as it enters, ray by ray: light from all around as it is, each ray from a direction of its own
// that no part of the body hides, and what the surface reflects onto other parts. The shader that includes it, behind
// walk_start.glsl, has `field` and push constants `push` as TransportWalkPush does, and defines go_in behind it.
#ifndef QUADGRAPH_ENTERING_LIGHT_GLSL
#define QUADGRAPH_ENTERING_LIGHT_GLSL

#include "source/walk_start.glsl"
#include "transport/entering_rays.glsl"
#include "transport/transport_surface.glsl"

uint state;
vec3 entered, entered_again;

// Follows a ray inside.
void go_in(Ray ray);

// Puts the ray where it enters. Returns 0 if it enters nowhere, else 1.
float enter_again(Entrance entry, inout Ray ray) {
  if (entry.face == NO_FACE) return 0.0;
  ray.at = entrance_point(entry);
  ray.direction = entry.direction;
  return 1.0;
}

// A reflected ray is followed by chance, as it is little light and takes as long as what went in: so many times its
// share of the latter.
const float REFLECTED_RAYS = 4.0;

// Turns a ray that went in into what facets of that normal reflected of it, where that enters elsewhere; what they
// reflect into the face is lost. direction: outside, the way the light travels. False where there is none.
bool enters_reflected(vec3 direction, vec3 facet, uint face, Frame at, inout Ray ray) {
  if (!reflects(at.surface) || !sees_body(face)) return false;
  float cosine = clamp(-dot(direction, facet), 0.0, 1.0);
  float transmitted = surface_transmittance(cosine, at.surface);
  if (transmitted < 1e-3) return false;
  float reflected = 1.0 / transmitted - 1.0, chance = min(REFLECTED_RAYS * reflected, 1.0);
  if (uniform_number(state) >= chance) return false;
  vec3 mirrored = normalize(direction + 2.0 * cosine * facet);
  if (facet != at.normal && dot(mirrored, at.normal) <= 0.0) return false;
  Entrance entry = through_air(face, at.position, mirrored, state);
  if (entry.face == NO_FACE) return false;
  ray = Ray(entrance_point(entry), entry.direction, reflected / chance * ray.power, vec3(0), 1.0);
  entered_again += ray.power;
  return true;
}

// By its facets one by one: the ray of so much power that goes in, or enters elsewhere; false where none does.
bool enters_by_facets(vec3 direction, vec3 facet, uint face, TetPoint point, Frame at, vec3 power, out Ray ray) {
  ray = start(point, direction, power / surface_transmittance(clamp(-dot(direction, facet), 0.0, 1.0), at.surface));
  if (goes_through_facets(false, facet, at.surface, two_numbers(state), direction, state)) {
    ray.direction = into_face(direction, at.normal, facet);
    return true;
  }
  if (!sees_body(face) || dot(direction, at.normal) <= 0.0) return false;
  ray.power *= enter_again(through_air(face, at.position, direction, state), ray);
  return ray.power != vec3(0);
}

// A ray on its way to a face.
struct Arriving {
  vec3 l;          // barycentric coordinates of where it enters
  vec3 power;      // W, scaled
  uint number;     // of its origin, among all of the surface
  vec3 direction;  // of a sky: the way it travels
};

// The one of a sky, without power where it is hidden.
Arriving from_sky(Beam beam, uint face, uint number, OpenFace open) {
  vec3 along = open.corners[1] - open.corners[0];
  SkyRay drawn = drawn_from_sky(beam, number, open.normal, open.leaning, along, open.surface, state);
  vec3 l = spread_over_face(number);
  vec3 power = open.area / float(push.rays) * drawn.let_in * push.scale.at[0].inverse;
  if (power != vec3(0) && field.sky.at[face] < 1.0 &&
      meets_any(line_along(open.corners * l, drawn.towards), face, FAR)) {
    power = vec3(0);
  }
  return Arriving(l, power, number, -drawn.towards);
}

// One of as many rays from each quarter of a face, from anywhere in it.
Arriving from_quarter(Beam beam, uint face, uint number, uint quarter, OpenFace open) {
  vec3 q = beam_light(beam, push.beam_q, BODY.face_count, face, quarter) * push.scale.at[0].inverse;
  return Arriving(spread_over_quarter(number, quarter), open.area / float(push.rays) * q, number, vec3(0));
}

// Follows what goes in, and then what is reflected: both by one call, as each call of this is compiled by itself.
void enter(Beam beam, uint face, uint ray, TetPoint point, Frame at, Arriving light) {
  entered += light.power;
  bool even = push.sky == 0u && beam.way.kind == BEAM_LAMBERTIAN;  // from all around, by a bundle
  bool one = even && push.rays == 1u;
  vec3 facet = even ? at.normal : at.facet, direction = light.direction;
  if (push.sky == 0u && !one) direction = incoming(beam.way, ray, at);
  Ray inside;
#ifdef FACET_BY_FACET
  bool by_facets = !one && at.surface.roughness > 0.0;
#else
  bool by_facets = false;
#endif
  if (by_facets) {
    if (!enters_by_facets(direction, facet, face, point, at, light.power, inside)) return;
  } else if (one) {
    inside = start_even(beam.way, point, at, light.power);
  } else {
    inside = start(point, way_in(direction, at.normal, facet, at.surface, state), light.power);
  }
  for (uint reflections = 0u; reflections < 2u; ++reflections) {
    // Of a bundle that one ray stands for no reflection is known; of facets one by one it is what did not go in.
    if (reflections == 1u && (one || by_facets || !enters_reflected(direction, facet, face, at, inside))) break;
    go_in(inside);
  }
}

// What enters by a face, of one ray: of a bundle from its place in each quarter, of other light from anywhere.
void let_in_by(uint face, uint ray) {
  entered = vec3(0);
  entered_again = vec3(0);
  Beam beam = push.beam.at[0];
  rays = push.rays;
  OpenFace open;
  if (!opens(face, open)) return;
  bool even = push.sky == 0u && beam.way.kind == BEAM_LAMBERTIAN;
  uint number = push.first + push.rays * face + ray, first = 0u, end = 1u;
  Origins from;
  from.tangent = vec3(0);
  if (even) {
    from = origins_of(beam.way, light_on(beam, face), open, face, ray);
    first = from.first;
    end = FACE_QUARTERS;
  }
  for (uint k = first; k < end; ++k) {
    state = hash(face ^ hash(ray + push.first));
    Arriving light;
    if (even) {
      light = Arriving(quarter_centre(k), power_from(from, k), origin_number(face, k), vec3(0));
    } else if (push.sky == 1u) {
      light = from_sky(beam, face, number, open);
    } else {
      light = from_quarter(beam, face, number, ray % FACE_QUARTERS, open);
    }
    if (light.power == vec3(0)) continue;
    Frame at = Frame(open.corners * light.l, open.normal, open.facet, from.tangent, light.number, open.surface);
    enter(beam, face, ray, start_on_face(open.tet, open.ids, light.l), at, light);
  }
}

#endif
