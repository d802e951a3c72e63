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
  Uints sums;     // fixed point, WALK_SUMS times TRANSPORT_WALK_SUMS: absorbed; left, or under way at the end; entered again; entered
  Uints towards;  // fixed point, as of TransportForwardRef; null where light scatters evenly
  Uints leaving;  // fixed point, per face: power that leaves unscattered; the same
  uint rays;      // a face; a multiple of FACE_QUARTERS where the beam has directions
  uint sky;       // 1: the beam is ambient light or an environment
  uint first;     // number of the first ray of the first face
  uint deposits;  // WALK_CORNERS
};
layout(push_constant, scalar) uniform Block { TransportWalkPush push; };

TransportFieldRef field;
#define FIELD field
#define BODY field.body
#define WALK_KIND WALK_CORNERS
#define WALK_TOWARDS push.towards
#include "source/walk_ray.glsl"
#include "transport/entering_light.glsl"

float next_chance() {
  return uniform_number(state);
}

void leave(uint face, vec3 power) {
  unscattered += power;
  if (uvec2(push.leaving) != uvec2(0)) add_power(push.leaving, face, power);
}

void meet_surface(inout Ray ray, uint face) {
  vec3 n = outward_normal(face);
  float cosine = dot(ray.direction, n);
  if (is_open(BODY.face_kinds, face)) {
    OpticalSurface surface = surface_of(BODY.face_kinds, face);
    float reflected = surface_reflectance_inside(cosine, surface);
    if (!sees_body(face)) {
      vec3 kept = ray.power * reflected;
      leave(face, ray.power - kept);
      ray.power = kept;
    } else if (uniform_number(state) >= reflected) {
      leave(face, ray.power);
      vec3 point = in_space(ray.at);
      ray.power *= enter_again(through_air(face, point, way_on(ray.direction, n, surface, true, state), state), ray);
      entered_again += ray.power;
      return;
    }
    ray.direction = way_on(ray.direction, n, surface, false, state);
    return;
  }
  ray.direction = normalize(ray.direction - 2.0 * cosine * n);
}

void go_in(Ray ray) {
  walk(ray);
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  field = push.field.at[0];
  absorbed = vec3(0);
  unscattered = vec3(0);
  if (i >= BODY.face_count * push.rays) return;
  uvec2 own = face_and_ray(i, push.rays);
  let_in_by(own.x, own.y);
  uint at = TRANSPORT_WALK_SUMS * (gl_WorkGroupID.x % WALK_SUMS);
  add_power(push.sums, at, absorbed);
  add_power(push.sums, at + 1u, unscattered);
  add_power(push.sums, at + 2u, entered_again);
  add_power(push.sums, at + 3u, entered);
}
