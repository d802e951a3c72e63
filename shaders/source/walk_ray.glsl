// One ray of the buried source through the tets. The shader that includes it defines first BODY (tet_ray.glsl) and push
// constants `push`, which have deposit and deposits as WalkSourcePush does, and defines meet_surface behind it.
#ifndef QUADGRAPH_WALK_RAY_GLSL
#define QUADGRAPH_WALK_RAY_GLSL

#include "source/fixed_point.glsl"
#include "source/walk_shared.h"

// Scattered towards a vertex, not yet added to its deposit.
struct Payload {
  vec3 scattered;
};

Payload payload(uint id) {
  return Payload(vec3(0));
}

#include "source/tet_ray.glsl"

struct Ray {
  uint tet;
  vec3 direction;
  vec3 power;
  vec3 carry;    // of power, that rounding kept back
  float slope;   // length of the way that it stands for, over its own
};

vec3 absorbed;     // by this invocation's rays
vec3 unscattered;  // of them: left through the surface, or still under way at the end

// Share of the loss that is scattered: never above 1, even where division rounds up.
vec3 albedo() {
  return min(optical.sigma_s_prime / max(extinction(), vec3(1e-30)), vec3(1));
}

// `scattered` at the mean place of each channel between the ray's point and `l`.
void scatter(uint tet, vec3 scattered, vec4 l, vec3 place) {
  if ((push.deposits & WALK_DEPOSITS) == WALK_TETS) {
    add_power(push.deposit, tet, scattered);
    return;
  }
  vec3 at_0 = scattered * mix(vec3(corner_0.l), vec3(l.x), place);
  vec3 at_1 = scattered * mix(vec3(corner_1.l), vec3(l.y), place);
  vec3 at_2 = scattered * mix(vec3(corner_2.l), vec3(l.z), place);
  vec3 at_3 = scattered * mix(vec3(corner_3.l), vec3(l.w), place);
  if ((push.deposits & WALK_DEPOSITS) == WALK_VERTICES) {
    corner_0.payload.scattered += at_0;
    corner_1.payload.scattered += at_1;
    corner_2.payload.scattered += at_2;
    corner_3.payload.scattered += at_3;
  } else {
    add_power(push.deposit, 4u * tet + corner_0.place, at_0);
    add_power(push.deposit, 4u * tet + corner_1.place, at_1);
    add_power(push.deposit, 4u * tet + corner_2.place, at_2);
    add_power(push.deposit, 4u * tet + corner_3.place, at_3);
  }
}

// What the present tet takes from the ray: the exact integral of sigma_s' e^-tau against the basis functions along the
// way to `l`, the rest absorbed.
void cross_tet(inout Ray ray, float length, vec4 l) {
  vec3 lost, place;
  attenuate(extinction() * length, lost, place);
  // The power that is taken is what its float loses, and the difference is carried: the sum over many tets is then exact.
  precise vec3 wanted = ray.power * lost + ray.carry;
  precise vec3 remaining = ray.power - clamp(wanted, vec3(0), ray.power);
  precise vec3 taken = ray.power - remaining;
  ray.carry = wanted - taken;
  ray.power = remaining;
  vec3 scattered = taken * albedo();
  absorbed += taken - scattered;
  scatter(ray.tet, scattered, l, place);
}

// Leaves all power at the ray's point; in a clear channel it counts as unscattered.
void end_here(Ray ray) {
  bvec3 clear = equal(extinction(), vec3(0));
  vec3 kept = mix(ray.power, vec3(0), clear);
  vec3 scattered = kept * albedo();
  absorbed += kept - scattered;
  unscattered += ray.power - kept;
  scatter(ray.tet, scattered, vec4(corner_0.l, corner_1.l, corner_2.l, corner_3.l), vec3(0));
}

void flush(Corner corner) {
  if ((push.deposits & WALK_DEPOSITS) == WALK_VERTICES) add_power(push.deposit, corner.id, corner.payload.scattered);
}

// Of its power, with which a ray that begins here ends. Where much is absorbed, what has not scattered reaches as deep
// as what has, so that it is followed in motion as at rest.
vec3 end_share() {
  if ((push.deposits & (WALK_TO_MEAN | WALK_TO_AGAIN)) == 0u) return vec3(WALK_END);
  float sooner = (push.deposits & WALK_TO_AGAIN) != 0u ? WALK_END_AGAIN : WALK_END_MEAN;
  return mix(vec3(WALK_END), vec3(sooner), greaterThan(albedo(), vec3(WALK_PALE)));
}

// At an outside face from inside, whose outward normal has any length.
void meet_surface(inout Ray ray, uint face, vec3 outward);

// Follows a ray from the point that the corners hold, until its light is spent.
void walk(Ray ray) {
  vec3 end = end_share() * ray.power;
  for (uint step = 0u; step < MAX_WALK_STEPS; ++step) {
    Exit exit = find_exit(ray.direction);
    if (!exit.found) break;
    vec4 l = exit_point(exit);
    cross_tet(ray, ray.slope * exit.path, l);
    move_to(l);
    bool spent = all(lessThanEqual(ray.power, end));
    if (spent && extinction() != vec3(0)) break;
    uvec2 crossing = turn(ray.tet, exit.slot);
    if (crossing.x < BODY.tet_count) {
      flush(corner_3);
      ray.tet = crossing.x;
      enter(crossing);
    } else {
      meet_surface(ray, crossing.x - BODY.tet_count, exit.outward);
      if (ray.power == vec3(0)) break;
    }
  }
  end_here(ray);
  flush(corner_0);
  flush(corner_1);
  flush(corner_2);
  flush(corner_3);
}

#endif
