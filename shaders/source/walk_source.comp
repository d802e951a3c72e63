#version 460
#extension GL_GOOGLE_include_directive : require
#include "source/walk_shared.h"
#include "material/fresnel.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { WalkSourcePush push; };

BodyRef body;
#define BODY body
#define WALK_KIND (push.deposits & WALK_DEPOSITS)
#include "source/walk_ray.glsl"
#include "source/walk_start.glsl"
#include "shared/random.glsl"

uint chance_state;

float next_chance() {
  return uniform_number(chance_state);
}

uint segments;  // tets, by this invocation's rays

// At an outside face from inside: part leaves, the rest goes on mirrored.
void meet_surface(inout Ray ray, uint face) {
  vec3 n = outward_normal(face);
  float cosine = dot(ray.direction, n);
  if (is_open(BODY.face_kinds, face)) {
    vec3 reflected = ray.power * surface_reflectance_inside(cosine, surface_of(BODY.face_kinds, face));
    vec3 leaving = ray.power - reflected;
    unscattered += leaving;
    add_power(push.unscattered, face, leaving);
    ray.power = reflected;
  }
  ray.direction = normalize(ray.direction - 2.0 * cosine * n);
}

// Ray `ray` of every origin on a face.
void walk_from(Beam beam, uint face, uint ray) {
  QuarterLight light = light_on(beam, face);
  OpenFace open;
  if (light.largest == vec3(0) || !opens(face, open)) return;
  Origins from = origins_of(beam.way, light, open, face, ray);
  for (uint k = from.first; k < FACE_QUARTERS; ++k) {
    vec3 power = power_from(from, k);
    if (power == vec3(0)) continue;
    vec3 l = quarter_centre(k);
    Frame at = Frame(open.corners * l, open.normal, open.facet, from.tangent, origin_number(face, k), open.surface);
    TetPoint point = start_on_face(open.tet, open.ids, l);
    vec3 facet = entered_by(beam.way, at);
    Ray inside = by_one_ray(beam.way)
                     ? start_even(beam.way, point, at, power)
                     : start(point, goes_in(incoming(beam.way, ray, at), at.normal, facet, at.surface), power);
    segments += walk(inside);
  }
}

uint rays_of(uint beam) {
  bool bundle = push.beams.at[beam].way.kind == BEAM_LAMBERTIAN && (push.deposits & WALK_ONE_RAY) == 0u;
  return bundle ? LAMBERTIAN_RAYS : 1u;
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  body = push.body.at[0];
  absorbed = vec3(0);
  unscattered = vec3(0);
  segments = 0u;
  uint per_face = 0u;
  for (uint b = 0u; b < push.beam_count; ++b) per_face += rays_of(b);
  if (i >= BODY.face_count * per_face) return;
  uvec2 own = face_and_ray(i, per_face);
  chance_state = hash(own.x ^ hash(own.y));
  uint ray = own.y;
  uint beam = 0u;
  while (ray >= rays_of(beam)) ray -= rays_of(beam++);
  rays = rays_of(beam);
  walk_from(push.beams.at[beam], own.x, ray);
  // In turn, so that invocations seldom wait for each other.
  uint at = gl_WorkGroupID.x % WALK_SUMS;
  add_power(push.sums, 2u * at, absorbed);
  add_power(push.sums, 2u * at + 1u, unscattered);
  atomicAdd(push.sums.at[2u * FIXED_WORDS * WALK_SUMS + at], segments);
}
