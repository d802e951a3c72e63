// Where the rays of a beam start. The shader that includes it has push constants `push` with
// beam_q and scale as WalkSourcePush does, sets `rays`, and defines follow behind it.
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

// Share of the power of a face that one ray takes, by its number.
float share_of(uint ray, OpticalSurface surface) {
  return rays == 1u ? 1.0 : 0.5 * lambertian(surface).share[ray / 2u];
}

float known_mean_cosine = 0.0, known_for = 0.0;  // and the index that it is known for; 0: none yet

float mean_cosine(OpticalSurface surface) {
  if (known_for != surface.eta) {
    Lambertian light = lambertian(surface);
    known_mean_cosine = dot(light.share, light.cosine);
    known_for = surface.eta;
  }
  return known_mean_cosine;
}

// Whether rays of a beam have their directions from the tangent of a face.
bool turned_by_face(BeamRecord way) {
  return way.kind == BEAM_MEAN || (way.kind == BEAM_LAMBERTIAN && rays > 1u);
}

// Inside direction of BEAM_MEAN.
vec3 mean_direction(Frame at) {
  float cosine = mean_cosine(at.surface);
  return normalize(sqrt(1.0 - cosine * cosine) * at.tangent - cosine * at.normal);
}

// The normal by which the light of a beam enters: of a bundle from all around that of the face.
vec3 entered_by(BeamRecord beam, Frame at) {
  return beam.kind == BEAM_LAMBERTIAN ? at.normal : at.facet;
}

// The way inside of light of a beam that travels along `direction` outside.
vec3 inside_way(BeamRecord beam, vec3 direction, Frame at) {
  return refracted_by_facet(direction, at.normal, entered_by(beam, at), at.surface.eta);
}

// The ray inside, of power that has entered at a point of a face. A Lambertian beam by one ray goes straight down, as
// deep as the mean of its directions: askew it would take light aside, each face to its own side.
Ray start(BeamRecord way, uint ray, TetPoint point, Frame at, vec3 power) {
  if (way.kind == BEAM_LAMBERTIAN && rays == 1u) {
    return Ray(point, -at.normal, power, vec3(0), 1.0 / mean_cosine(at.surface));
  }
  vec3 inside = way.kind == BEAM_MEAN ? mean_direction(at) : inside_way(way, incoming(way, ray, at), at);
  return Ray(point, inside, power, vec3(0), 1.0);
}

// Walks a ray from a point of a face.
void follow(BeamRecord way, uint ray, uint face, TetPoint point, Frame at, vec3 power);

// Face and ray of an invocation, of so many rays a face.
uvec2 face_and_ray(uint i, uint per_face) {
#ifdef QG_PROCESSOR
  return uvec2(i / per_face, i % per_face);  // rays near each other, so that what they cross stays in a cache
#else
  return uvec2(i % BODY.face_count, i / BODY.face_count);  // rays alike, so that none waits for others
#endif
}

// Ray `ray` of every origin on a face.
void walk_from(Beam beam, uint face, uint ray) {
  vec3 q[FACE_QUARTERS];
  vec3 inverse = push.scale.at[0].inverse;
  vec3 least = vec3(NEVER), largest = vec3(0), sum = vec3(0);
  for (uint k = 0u; k < FACE_QUARTERS; ++k) {
    q[k] = beam_light(beam, push.beam_q, BODY.face_count, face, k) * inverse;
    least = min(least, q[k]);
    largest = max(largest, q[k]);
    sum += q[k];
  }
  OpenFace open;
  if (largest == vec3(0) || !opens(face, open)) return;
  vec3 tangent = vec3(0);
  if (turned_by_face(beam.way)) tangent = face_tangent(face, open.normal, open.corners[1] - open.corners[0]);
  bool one = one_ray_does(least, largest, open.corners, open.area);
  float share = 0.25 * open.area * share_of(ray, open.surface);
  for (uint k = one ? FACE_CENTRE : 0u; k < FACE_QUARTERS; ++k) {
    vec3 power = share * (one ? sum : q[k]);
    if (power == vec3(0)) continue;
    vec3 l = quarter_centre(k);
    Frame at = Frame(open.corners * l, open.normal, open.facet, tangent, FACE_QUARTERS * face + k, open.surface);
    follow(beam.way, ray, face, start_on_face(open.tet, open.ids, l), at, power);
  }
}

#endif
