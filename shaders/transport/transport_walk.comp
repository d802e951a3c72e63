#version 460
#extension GL_GOOGLE_include_directive : require
#include "source/walk_shared.h"
#include "transport/transport_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// The walk of one beam (walk_source.comp) to the corners of tets, with what meets the body again after it was reflected
// outside or has left unscattered.
struct TransportWalkPush {
  TransportFieldRefs field;  // one
  Beams beam;                // one
  Floats beam_q;             // of all
  Scales scale;
  Uints deposit;  // fixed point, four per tet: power scattered for the first time
  Uints sums;     // fixed point, WALK_SUMS times three: absorbed; left, or under way at the end; entered again
  uint rays;      // as WalkSourcePush
  uint deposits;  // WALK_CORNERS
};
layout(push_constant, scalar) uniform Block { TransportWalkPush push; };

TransportFieldRef field;
#define FIELD field
#define BODY field.body
#include "source/walk_ray.glsl"
#include "source/walk_start.glsl"
#include "transport/transport_surface.glsl"

uint state;
vec3 entered_again;

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

// What the surface reflects of light whose power `entered`, where that enters elsewhere. Of a bundle that one ray stands
// for no reflection is known.
void follow_reflected(BeamRecord way, uint ray, uint face, Frame at, vec3 entered) {
  if (BODY.eta == 1.0 || !sees_body(face) || (way.kind == BEAM_LAMBERTIAN && push.rays == 1u)) return;
  vec3 direction = incoming(way, ray, at);
  float cosine = clamp(-dot(direction, at.normal), 0.0, 1.0);
  float transmitted = fresnel_transmittance(cosine, BODY.eta);
  direction = normalize(direction + 2.0 * cosine * at.normal);
  if (transmitted < 1e-3) return;
  Ray reflected = Ray(0u, direction, (1.0 / transmitted - 1.0) * entered, vec3(0), 1.0);
  if (enter_again(through_air(face, at.position, direction, state), reflected) == 0.0) return;
  entered_again += reflected.power;
  walk(reflected);
}

void follow(BeamRecord way, uint ray, uint face, Frame at, vec3 power) {
  state = hash(face ^ hash(ray));
  walk(start(way, ray, BODY.face_tets.at[face], at, power));
  follow_reflected(way, ray, face, at, power);
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  field = push.field.at[0];
  absorbed = vec3(0);
  unscattered = vec3(0);
  entered_again = vec3(0);
  if (i >= BODY.face_count * push.rays) return;
  walk_from(i % BODY.face_count, i / BODY.face_count);
  uint at = 3u * (gl_WorkGroupID.x % WALK_SUMS);
  add_power(push.sums, at, absorbed);
  add_power(push.sums, at + 1u, unscattered);
  add_power(push.sums, at + 2u, entered_again);
}
