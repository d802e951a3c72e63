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

// What facets of that normal reflect of light that travels along `direction` and whose power `went_in`, where that
// enters elsewhere; what they reflect into the face is lost.
void follow_reflected(vec3 direction, vec3 facet, uint face, Frame at, vec3 went_in) {
  if (!reflects(at.surface) || !sees_body(face)) return;
  float cosine = clamp(-dot(direction, facet), 0.0, 1.0);
  float transmitted = fresnel_transmittance(cosine, at.surface);
  if (transmitted < 1e-3) return;
  float reflected = 1.0 / transmitted - 1.0, chance = min(REFLECTED_RAYS * reflected, 1.0);
  if (uniform_number(state) >= chance) return;
  vec3 mirrored = normalize(direction + 2.0 * cosine * facet);
  if (facet != at.normal && dot(mirrored, at.normal) <= 0.0) return;
  Entrance entry = through_air(face, at.position, mirrored, state);
  if (entry.face == NO_FACE) return;
  Ray ray = Ray(entrance_point(entry), entry.direction, reflected / chance * went_in, vec3(0), 1.0);
  entered_again += ray.power;
  go_in(ray);
}

// Of a beam whose light comes evenly from everywhere.
void follow(BeamRecord way, uint ray, uint face, TetPoint point, Frame at, vec3 power) {
  state = hash(face ^ hash(ray + push.first));
  entered += power;
  go_in(start(way, ray, point, at, power));
  // Of a bundle that one ray stands for no reflection is known.
  if (push.rays == 1u) return;
  follow_reflected(incoming(way, ray, at), entered_by(way, at), face, at, power);
}

// A point of a face, by its barycentric coordinates. It has a direction without a tangent. number: of the ray.
Frame frame_at(OpenFace open, vec3 l, uint number) {
  return Frame(open.corners * l, open.normal, open.facet, vec3(0), number, open.surface);
}

// From where it entered by facets, and on from there what these reflect. direction: outside, the way the light travels.
void enter(OpenFace open, uint face, vec3 l, Frame at, vec3 direction, vec3 power) {
  entered += power;
  vec3 inside = refracted_by_facet(direction, at.normal, open.facet, at.surface.eta);
  go_in(Ray(start_on_face(open.tet, open.ids, l), inside, power, vec3(0), 1.0));
  follow_reflected(direction, open.facet, face, at, power);
}

void walk_from_sky(Beam beam, uint face, uint ray) {
  OpenFace open;
  if (!opens(face, open)) return;
  uint number = push.first + push.rays * face + ray;
  state = hash(face ^ hash(ray + push.first));
  vec3 along = open.corners[1] - open.corners[0];
  SkyRay drawn = drawn_from_sky(beam, number, open.normal, open.leaning, along, open.surface, state);
  vec3 power = open.area / float(push.rays) * drawn.let_in * push.scale.at[0].inverse;
  if (power == vec3(0)) return;
  vec3 l = spread_over_face(number);
  Frame at = frame_at(open, l, number);
  if (field.sky.at[face] < 1.0 && meets_any(line_along(at.position, drawn.towards), face, FAR)) return;
  enter(open, face, l, at, -drawn.towards, power);
}

// One of as many rays from each quarter of a face, from anywhere in it.
void walk_from_quarter(Beam beam, uint face, uint ray) {
  OpenFace open;
  if (!opens(face, open)) return;
  uint number = push.first + push.rays * face + ray, quarter = ray % FACE_QUARTERS;
  vec3 q = beam_light(beam, push.beam_q, BODY.face_count, face, quarter) * push.scale.at[0].inverse;
  if (q == vec3(0)) return;
  vec3 l = spread_over_quarter(number, quarter);
  state = hash(face ^ hash(ray + push.first));
  Frame at = frame_at(open, l, number);
  enter(open, face, l, at, incoming(beam.way, ray, at), open.area / float(push.rays) * q);
}

// What enters by a face, of one ray.
void let_in_by(uint face, uint ray) {
  entered = vec3(0);
  entered_again = vec3(0);
  Beam beam = push.beam.at[0];
  rays = push.rays;
  if (push.sky == 1u) {
    walk_from_sky(beam, face, ray);
  } else if (beam.way.kind == BEAM_LAMBERTIAN) {
    walk_from(beam, face, ray);
  } else {
    walk_from_quarter(beam, face, ray);
  }
}

#endif
