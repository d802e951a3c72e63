// Where the rays of a beam start. The shader that includes it has push constants `push` with
// beam_q and scale as WalkSourcePush does, and sets `rays`.
#ifndef QUADGRAPH_WALK_START_GLSL
#define QUADGRAPH_WALK_START_GLSL

#include "source/beam_light.glsl"
#include "source/face_azimuth.glsl"
#include "source/lambertian.glsl"
#include "source/leaning.glsl"
#include "source/light_ray.glsl"
#include "source/rectangle_light.glsl"

const uint FACE_CENTRE = 3u;  // the quarter in the middle

uint rays;  // of the beam, per origin

// Barycentric coordinates of the centroid of a quarter.
vec3 quarter_centre(uint quarter) {
  vec3 l = vec3(quarter == FACE_CENTRE ? 1.0 / 3.0 : 1.0 / 6.0);
  if (quarter != FACE_CENTRE) l[quarter] = 2.0 / 3.0;
  return l;
}

// One ray stands for a face whose quarters are lit alike and that is compact.
bool one_ray_does(vec3 least, vec3 largest, mat3 corners, float area) {
  vec3 e_0 = corners[1] - corners[0], e_1 = corners[2] - corners[1], e_2 = corners[0] - corners[2];
  float longest = max(dot(e_0, e_0), max(dot(e_1, e_1), dot(e_2, e_2)));
  return longest <= 8.0 * area && all(lessThanEqual(largest - least, largest / 16.0));
}

// A face that light can enter by.
struct OpenFace {
  uint tet;
  uvec3 ids;
  mat3 corners;
  vec3 normal;
  Leaning leaning;
  vec3 facet;  // normal of what it is made of
  float area;  // mm^2
  OpticalSurface surface;
};

// Whether light can enter by a face.
bool opens(uint face, out OpenFace open) {
  if (!is_open(BODY.face_kinds, face)) return false;
  open.ids = BODY.faces.at[face];
  open.corners = corners_of(open.ids);
  vec3 doubled = cross(open.corners[1] - open.corners[0], open.corners[2] - open.corners[0]);
  open.area = 0.5 * length(doubled);
  if (open.area == 0.0) return false;
  open.normal = doubled / (2.0 * open.area);
  open.leaning = leaning_of(BODY.face_kinds, face, open.normal, open.corners[1] - open.corners[0],
                            open.corners[2] - open.corners[0]);
  open.facet = facet_normal(open.leaning);
  open.tet = BODY.face_tets.at[face];
  open.surface = surface_of(BODY.face_kinds, face);
  return true;
}

struct Frame {
  vec3 position, normal, facet, tangent;
  uint number;  // of the origin of rays, among all of the surface
  OpticalSurface surface;
};

// The way light travels outside, at a point of a face.
vec3 incoming(BeamRecord beam, uint ray, Frame at) {
  if (beam.kind == BEAM_DIRECTIONAL) return beam.travel_or_from;
  if (beam.kind == BEAM_POINT) return normalize(at.position - beam.travel_or_from);
  if (beam.kind == BEAM_RECTANGLE) return rectangle_incoming(beam, at.position, at.facet, at.number, at.surface);
  return lambertian_incoming(ray, at.normal, at.tangent);
}

// The bundle of rays that stands for even light on a surface, and the surface that it is of; none yet.
Lambertian bundle;
OpticalSurface bundle_of = OpticalSurface(0.0, 0.0, 0.0, 0.0, 0.0, uvec2(0));

void find_bundle(OpticalSurface surface) {
  bool known = surface.eta == bundle_of.eta && surface.coat_eta == bundle_of.coat_eta;
  if (known && surface.coat == bundle_of.coat && surface.roughness == bundle_of.roughness) return;
  bundle = lambertian(surface);
  bundle_of = surface;
}

// Share of the power of a face that one ray takes, by its number.
float share_of(uint ray) {
  return rays == 1u ? 1.0 : 0.5 * bundle.share[ray / 2u];
}

// Whether a beam is even light, for which find_bundle is due; and whether one ray stands for all of it.
bool is_even(BeamRecord way) {
  return way.kind == BEAM_MEAN || way.kind == BEAM_LAMBERTIAN;
}
bool by_one_ray(BeamRecord way) {
  return way.kind == BEAM_MEAN || (way.kind == BEAM_LAMBERTIAN && rays == 1u);
}

// Whether rays of a beam have their directions from the tangent of a face.
bool turned_by_face(BeamRecord way) {
  return way.kind == BEAM_MEAN || (way.kind == BEAM_LAMBERTIAN && rays > 1u);
}

// The one ray inside for even light. A Lambertian beam goes straight down, as deep as the mean of its directions: askew
// it would take light aside, each face to its own side.
Ray start_even(BeamRecord way, TetPoint point, Frame at, vec3 power) {
  float cosine = dot(bundle.share, bundle.cosine);
  if (way.kind == BEAM_LAMBERTIAN) return Ray(point, -at.normal, power, vec3(0), 1.0 / cosine);
  vec3 inside = normalize(sqrt(1.0 - cosine * cosine) * at.tangent - cosine * at.normal);
  return Ray(point, inside, power, vec3(0), 1.0);
}

// The ray inside, of power that has entered at a point of a face.
Ray start(TetPoint point, vec3 inside, vec3 power) {
  return Ray(point, inside, power, vec3(0), 1.0);
}

// The normal by which the light of a beam enters: of a bundle from all around that of the face.
vec3 entered_by(BeamRecord beam, Frame at) {
  return beam.kind == BEAM_LAMBERTIAN ? at.normal : at.facet;
}

// Face and ray of an invocation, of so many rays a face.
uvec2 face_and_ray(uint i, uint per_face) {
#ifdef QG_PROCESSOR
  return uvec2(i / per_face, i % per_face);  // rays near each other, so that what they cross stays in a cache
#else
  return uvec2(i % BODY.face_count, i / BODY.face_count);  // rays alike, so that none waits for others
#endif
}

// Light of a beam on the quarters of a face, W/mm^2, scaled.
struct QuarterLight {
  vec3 q[FACE_QUARTERS];
  vec3 least, largest, sum;
};

QuarterLight light_on(Beam beam, uint face) {
  QuarterLight light;
  light.least = vec3(NEVER);
  light.largest = vec3(0);
  light.sum = vec3(0);
  vec3 inverse = push.scale.at[0].inverse;
  for (uint k = 0u; k < FACE_QUARTERS; ++k) {
    light.q[k] = beam_light(beam, push.beam_q, BODY.face_count, face, k) * inverse;
    light.least = min(light.least, light.q[k]);
    light.largest = max(light.largest, light.q[k]);
    light.sum += light.q[k];
  }
  return light;
}

// The origins of rays on a face: the middles of its quarters from `first` on, or one for the whole face.
struct Origins {
  QuarterLight light;
  uint first;
  bool one;
  float share;   // mm^2, of the light of each, that the ray takes
  vec3 tangent;  // of the face, where directions are by it
};

Origins origins_of(BeamRecord way, QuarterLight light, OpenFace open, uint face, uint ray) {
  if (is_even(way)) find_bundle(open.surface);
  Origins from;
  from.light = light;
  from.one = one_ray_does(light.least, light.largest, open.corners, open.area);
  from.first = from.one ? FACE_CENTRE : 0u;
  from.share = 0.25 * open.area * share_of(ray);
  from.tangent = vec3(0);
  if (turned_by_face(way)) from.tangent = face_tangent(face, open.normal, open.corners[1] - open.corners[0]);
  return from;
}

vec3 power_from(Origins from, uint quarter) {
  return from.share * (from.one ? from.light.sum : from.light.q[quarter]);
}

// Number of an origin among all of the surface.
uint origin_number(uint face, uint quarter) {
  return FACE_QUARTERS * face + quarter;
}

#endif
