#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/environment_picture.h"
#include "source/walk_shared.h"
#include "transport/transport_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// The walk of one beam (walk_source.comp) to the corners of tets, with what meets the body again after it was reflected
// outside or has left unscattered. Light from all around comes as it is, each ray from a direction of its own that no
// part of the body hides.
struct TransportWalkPush {
  TransportFieldRefs field;  // one
  Beams beam;                // one
  Floats beam_q;             // of all
  Scales scale;
  Uints deposit;  // fixed point, four per tet: power scattered for the first time
  Uints sums;     // fixed point, WALK_SUMS times TRANSPORT_WALK_SUMS: absorbed; left, or under way at the end; entered again; entered
  uint rays;      // a face; a multiple of FACE_QUARTERS where the beam has directions
  uint sky;       // 1: the beam is ambient light or an environment
  uint deposits;  // WALK_CORNERS
};
layout(push_constant, scalar) uniform Block { TransportWalkPush push; };

TransportFieldRef field;
#define FIELD field
#define BODY field.body
#include "source/walk_ray.glsl"
#include "source/walk_start.glsl"
#include "transport/transport_surface.glsl"

const uint SKY_CANDIDATES = 8u;  // directions that one is drawn from, by what it brings

uint state;
vec3 entered, entered_again;

// Puts the ray where it enters. Returns 0 if it enters nowhere, else 1.
float enter_again(Entrance entry, inout Ray ray) {
  if (entry.face == NO_FACE) return 0.0;
  uvec3 ids = BODY.faces.at[entry.face];
  ray.tet = BODY.face_tets.at[entry.face];
  ray.direction = entry.direction;
  start_on_face(ray.tet, ids, corners_of(ids), vec3(max(1.0 - entry.place.x - entry.place.y, 0.0), entry.place));
  return 1.0;
}

void meet_surface(inout Ray ray, uint face, vec3 outward) {
  vec3 n = outward / length(outward);
  float cosine = dot(ray.direction, n);
  if (BODY.face_kinds.at[face] == FACE_OPEN) {
    float reflected = internal_reflectance(cosine, BODY.eta);
    if (!sees_body(face)) {
      vec3 kept = ray.power * reflected;
      unscattered += ray.power - kept;
      ray.power = kept;
    } else if (uniform_number(state) >= reflected) {
      vec3 point = corner_0.l * corner_0.position + corner_1.l * corner_1.position + corner_2.l * corner_2.position;
      unscattered += ray.power;
      ray.power *= enter_again(through_air(face, point, leaving_direction(ray.direction, n, cosine), state), ray);
      entered_again += ray.power;
      return;
    }
  }
  ray.direction = normalize(ray.direction - 2.0 * cosine * n);
}

// What the surface reflects of light that travels along `direction` and whose power `went_in`, where that enters
// elsewhere.
void follow_reflected(vec3 direction, uint face, vec3 point, vec3 normal, vec3 went_in) {
  if (BODY.eta == 1.0 || !sees_body(face)) return;
  float cosine = clamp(-dot(direction, normal), 0.0, 1.0);
  float transmitted = fresnel_transmittance(cosine, BODY.eta);
  direction = normalize(direction + 2.0 * cosine * normal);
  if (transmitted < 1e-3) return;
  Ray reflected = Ray(0u, direction, (1.0 / transmitted - 1.0) * went_in, vec3(0), 1.0);
  if (enter_again(through_air(face, point, direction, state), reflected) == 0.0) return;
  entered_again += reflected.power;
  walk(reflected);
}

// Of a beam whose light comes evenly from everywhere.
void follow(BeamRecord way, uint ray, uint face, Frame at, vec3 power) {
  state = hash(face ^ hash(ray));
  entered += power;
  walk(start(way, ray, BODY.face_tets.at[face], at, power));
  // Of a bundle that one ray stands for no reflection is known.
  if (push.rays == 1u) return;
  follow_reflected(incoming(way, ray, at), face, at.position, at.normal, power);
}

// W/(mm^2 sr) from a direction.
vec3 sky_radiance(Beam beam, vec3 towards) {
  if (uvec2(beam.picture) == uvec2(0)) return beam.colour / 3.1415927;
  mat3 frame = mat3(beam.way.u, beam.way.v, beam.way.travel_or_from);
  return max(beam.colour * environment_in(beam.picture, frame, ENVIRONMENT_RAYS, towards), vec3(0));
}

// A ray of the sky that enters a face where nothing hides it.
struct SkyRay {
  vec3 towards;  // outside
  vec3 let_in;   // of what comes from there, pi times radiance times transmittance, by the chance that it was drawn
};

// Drawn among candidates by what they bring (resampled importance sampling, Talbot, Cline and Egbert 2005), which are
// spread over the hemisphere by its cosine.
SkyRay drawn_from_sky(Beam beam, uint number, vec3 normal, vec3 tangent) {
  SkyRay drawn = SkyRay(normal, vec3(0));
  vec3 other = cross(normal, tangent);
  float all = 0.0, chosen = 1.0;
  for (uint k = 0u; k < SKY_CANDIDATES; ++k) {
    uint n = SKY_CANDIDATES * number + k;
    float square = spread_number(0u, n, 0u), azimuth = 6.2831853 * spread_number(0u, n, 1u);
    vec3 across = cos(azimuth) * tangent + sin(azimuth) * other;
    vec3 towards = sqrt(square) * normal + sqrt(1.0 - square) * across;
    vec3 let_in = 3.1415927 * fresnel_transmittance(sqrt(square), BODY.eta) * sky_radiance(beam, towards);
    float weight = let_in.x + let_in.y + let_in.z;
    all += weight;
    if (uniform_number(state) * all < weight) {
      drawn = SkyRay(towards, let_in);
      chosen = weight;
    }
  }
  drawn.let_in *= all / (float(SKY_CANDIDATES) * chosen);
  return drawn;
}

// Barycentric coordinates of a place on a face, anywhere in it. number: of the ray, among all of the surface.
vec3 spread_over_face(uint number) {
  float side = sqrt(spread_number(0u, number, 3u)), along = side * spread_number(0u, number, 4u);
  return vec3(1.0 - side, side - along, along);
}

// From where it entered, and on from there what the surface reflects. direction: outside, the way the light travels.
void enter(OpenFace open, uint face, vec3 l, vec3 direction, vec3 power) {
  entered += power;
  start_on_face(open.tet, open.ids, open.corners, l);
  walk(Ray(open.tet, refracted(direction, open.normal, BODY.eta), power, vec3(0), 1.0));
  follow_reflected(direction, face, open.corners * l, open.normal, power);
}

void walk_from_sky(Beam beam, uint face, uint ray) {
  OpenFace open;
  if (!opens(face, open)) return;
  uint number = push.rays * face + ray;
  state = hash(face ^ hash(ray));
  SkyRay drawn = drawn_from_sky(beam, number, open.normal, normalize(open.corners[1] - open.corners[0]));
  vec3 power = open.area / float(push.rays) * drawn.let_in * push.scale.at[0].inverse;
  if (power == vec3(0)) return;
  vec3 l = spread_over_face(number), point = open.corners * l;
  if (field.sky.at[face] < 1.0 && first_met(line_along(point, drawn.towards), face, FAR).face != NO_FACE) return;
  enter(open, face, l, -drawn.towards, power);
}

// One of as many rays from each quarter of a face, from anywhere in it.
void walk_from_quarter(Beam beam, uint face, uint ray) {
  OpenFace open;
  if (!opens(face, open)) return;
  uint number = push.rays * face + ray, quarter = ray % FACE_QUARTERS;
  vec3 q = beam_light(beam, push.beam_q, BODY.face_count, face, quarter) * push.scale.at[0].inverse;
  if (q == vec3(0)) return;
  vec3 l = 0.5 * spread_over_face(number);
  if (quarter == FACE_CENTRE) {
    l = 0.5 - l;
  } else {
    l[quarter] += 0.5;
  }
  state = hash(face ^ hash(ray));
  Frame at = Frame(open.corners * l, open.normal, vec3(0), number);  // it has a direction without a tangent
  enter(open, face, l, incoming(beam.way, ray, at), open.area / float(push.rays) * q);
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  field = push.field.at[0];
  absorbed = vec3(0);
  unscattered = vec3(0);
  entered = vec3(0);
  entered_again = vec3(0);
  if (i >= BODY.face_count * push.rays) return;
  uint face = i % BODY.face_count, ray = i / BODY.face_count;
  Beam beam = push.beam.at[0];
  if (push.sky == 1u) {
    walk_from_sky(beam, face, ray);
  } else if (beam.way.kind == BEAM_LAMBERTIAN) {
    walk_from(face, ray);
  } else {
    walk_from_quarter(beam, face, ray);
  }
  uint at = TRANSPORT_WALK_SUMS * (gl_WorkGroupID.x % WALK_SUMS);
  add_power(push.sums, at, absorbed);
  add_power(push.sums, at + 1u, unscattered);
  add_power(push.sums, at + 2u, entered_again);
  add_power(push.sums, at + 3u, entered);
}
