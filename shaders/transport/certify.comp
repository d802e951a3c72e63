#version 460
#extension GL_GOOGLE_include_directive : require
#include "source/walk_shared.h"
#include "shared/forward_scattering.h"
#include "transport/transport_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// Random walks of the light of one beam, one channel each, until they leave the body or are absorbed: transport itself,
// of the tets and their coefficients, without bias. What leaves is added up by face, before chance decides whether it
// does (next-event estimation at the surface). Light scatters by the phase function of Henyey and Greenstein.
struct CertifyPush {
  TransportFieldRefs field;  // one
  Beams beam;                // one
  Floats beam_q;             // of all
  Scales scale;
  Uints leaving;  // fixed point, per face: power that leaves there and has scattered; with any g all that leaves
  // Fixed point, WALK_SUMS times CERTIFY_SUMS: absorbed; left unscattered; given up. Behind them WALK_SUMS times two plain
  // numbers: walks, and tets that they crossed.
  Uints sums;
  Vec3s importance;  // per vertex, where walks are guided: 1 where a walk begins, on average
  vec3 g;         // mean cosine of the angle by which light scatters
  vec3 walk;      // power that a walk stands for, scaled; 0 in a channel without light
  vec3 unit;      // power that it counts with, scaled
  uint rays;      // a face, as of TransportWalkPush
  uint sky;       // the same
  uint first;     // the same
  uint guided;    // 1: by importance
};
layout(push_constant, scalar) uniform Block { CertifyPush push; };

TransportFieldRef field;
#define FIELD field
#define BODY field.body
#define FACET_BY_FACET
#include "source/fixed_point.glsl"
#include "transport/entering_light.glsl"
#include "transport/importance.glsl"

vec3 given_up;
bool scattered;  // the present walk has
uint walks, crossed;

// A part of the present walk.
struct Waiting {
  Ray ray;
  bool scattered;
};
Waiting waiting[MOST_WAITING];
uint waiting_count;

// Optical depth to the next collision.
float free_depth() {
  return -log(1.0 - uniform_number(state));
}

// What a walk of one unit counts with where it is as important as where walks begin.
float importance_here(TetPoint at, uint channel) {
  return push.guided == 0u ? 1.0 : dot(at.l, importance_at_corners(at.tet, channel));
}

// Divides a walk that counts with `share` units, or some.
void divide(inout Ray ray, float share) {
  uint parts = min(uint(share), MOST_WAITING - waiting_count + 1u);
  ray.power /= float(parts);
  for (uint k = 1u; k < parts; ++k) {
    waiting[waiting_count] = Waiting(ray, scattered);
    ++waiting_count;
  }
}

// Ends a walk that counts for little by chance, or divides one that counts for much, without bias.
void weigh(inout Ray ray, uint channel) {
  float worth = importance_here(ray.at, channel), share = worth * ray.power[channel] / push.unit[channel];
  float least = push.guided == 0u ? PLAIN_LEAST : GUIDED_LEAST;
  if (share < least) {
    float kept = push.guided == 0u ? PLAIN_LEAST : 1.0;
    ray.power[channel] = kept * uniform_number(state) < share ? kept * push.unit[channel] / worth : 0.0;
  } else if (push.guided == 1u && share >= GUIDED_MOST) {
    divide(ray, share);
  }
}

void count_leaving(uint face, vec3 power) {
  if (scattered || push.g != vec3(0)) {
    add_power(push.leaving, face, power);
  } else {
    unscattered += power;
  }
}

// On its way through the air from a face that sees the body, if it has left, or inside.
void go_on_from(uint face, bool left, vec3 direction, inout Ray ray) {
  if (left) {
    ray.power *= sees_body(face) ? enter_again(through_air(face, in_space(ray.at), direction, state), ray) : 0.0;
  } else {
    ray.direction = direction;
  }
}

// A smooth surface mirrors part of what meets it, and lets out the rest.
void meet_smooth(inout Ray ray, uint face, vec3 n, OpticalSurface surface) {
  float cosine = clamp(dot(ray.direction, n), 0.0, 1.0), reflected = internal_reflectance(cosine, surface);
  vec3 leaving = (1.0 - reflected) * ray.power;
  count_leaving(face, leaving);
  bool leaves = sees_body(face) && uniform_number(state) >= reflected;
  if (!sees_body(face)) ray.power -= leaving;
  go_on_from(face, leaves, way_on(ray.direction, n, surface, leaves, state), ray);
}

void meet_surface(inout Ray ray, uint face) {
  vec3 n = outward_normal(face);
  if (!is_open(BODY.face_kinds, face)) {
    ray.direction = normalize(ray.direction - 2.0 * clamp(dot(ray.direction, n), 0.0, 1.0) * n);
    return;
  }
  OpticalSurface surface = surface_of(BODY.face_kinds, face);
  if (surface.roughness == 0.0) {
    meet_smooth(ray, face, n, surface);
  } else {
    vec3 direction = ray.direction;
    bool leaves = goes_through_facets(true, n, surface, two_numbers(state), direction, state);
    if (leaves) count_leaving(face, ray.power);
    go_on_from(face, leaves, direction, ray);
  }
}

// sigma_s, all of it, and sigma_a, 1/mm; the body of the rays has it without the forward peak.
vec2 coefficients_in(uint tet, uint channel) {
  Optical optical = optical_in(tet);
  vec3 sigma_s = optical.sigma_s_prime / (1.0 - forward_peak(push.g));
  return vec2(sigma_s[channel], optical.sigma_a[channel]);
}

// After a path through the present tet.
void collide(inout Ray ray, uint channel, vec2 sigma, Exit exit, float path) {
  vec4 l = max(ray.at.l + path * exit.rate, vec4(0));
  ray.at.l = l / (l.x + l.y + l.z + l.w);
  ray.at.barred = vec4(0);
  vec3 kept = sigma.x / (sigma.x + sigma.y) * ray.power;
  absorbed += ray.power - kept;
  ray.power = kept;
  vec3 from = ray.direction;
  ray.direction = scattered_from(from, push.g[channel], state);
  if (push.guided == 1u) ray.power *= turn_to_more(ray.at, from, channel, push.g[channel], sigma, ray.direction, state);
  scattered = true;
}

// To its end, but for parts of it that wait.
void wander(Ray ray, uint channel) {
  float depth = free_depth();
  for (uint step = 0u; step < CERTIFY_STEPS; ++step) {
    Exit exit = find_exit(ray.at, ray.direction);
    if (!exit.found) break;
    ++crossed;
    vec2 sigma = coefficients_in(ray.at.tet, channel);
    float sigma_t = sigma.x + sigma.y, tau = sigma_t * exit.path;
    if (tau > depth) {
      collide(ray, channel, sigma, exit, depth / sigma_t);
      depth = free_depth();
      weigh(ray, channel);
    } else {
      depth -= tau;
      ray.at.l = exit_point(ray.at, exit);
      uint crossing = crossing_at(ray.at.tet, exit.place), across = crossing >> CROSSING_BITS;
      if (across < BODY.tet_count) {
        if (bends(ray.at.tet, across) &&
            !goes_through(ray.at.tet, exit.place, across, uniform_number(state), ray.direction)) {
          bar(ray.at, exit.place);
          continue;
        }
        enter(ray.at, exit.place, crossing);
        continue;
      }
      bar(ray.at, exit.place);
      meet_surface(ray, across - BODY.tet_count);
      weigh(ray, channel);
    }
    if (ray.power[channel] == 0.0) return;
  }
  given_up += ray.power;
}

void walk(Ray ray, uint channel) {
  waiting[0] = Waiting(ray, false);
  waiting_count = 1u;
  while (waiting_count > 0u) {
    --waiting_count;
    scattered = waiting[waiting_count].scattered;
    wander(waiting[waiting_count].ray, channel);
  }
}

// As many walks as its power stands for where it enters, on average.
void go_in(Ray ray) {
  for (uint c = 0u; c < 3u; ++c) {
    if (push.walk[c] == 0.0) continue;
    float worth = importance_here(ray.at, c);
    uint count = uint(worth * ray.power[c] / push.walk[c] + uniform_number(state));
    Ray one = ray;
    one.power = vec3(0);
    one.power[c] = push.unit[c] / worth;
    for (uint k = 0u; k < count; ++k) walk(one, c);
    walks += count;
  }
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  field = push.field.at[0];
  absorbed = vec3(0);
  unscattered = vec3(0);
  given_up = vec3(0);
  walks = 0u;
  crossed = 0u;
  if (i >= BODY.face_count * push.rays) return;
  uvec2 own = face_and_ray(i, push.rays);
  let_in_by(own.x, own.y);
  uint group = gl_WorkGroupID.x % WALK_SUMS, at = CERTIFY_SUMS * group;
  add_power(push.sums, at, absorbed);
  add_power(push.sums, at + 1u, unscattered);
  add_power(push.sums, at + 2u, given_up);
  uint counts = CERTIFY_SUMS * FIXED_WORDS * WALK_SUMS + 2u * group;
  atomicAdd(push.sums.at[counts], walks);
  atomicAdd(push.sums.at[counts + 1u], crossed);
}
