// One ray of the buried source through the tets. The shader that includes it defines first BODY (tet_ray.glsl) and push
// constants `push`, which have deposit and deposits as WalkSourcePush does, and defines meet_surface and next_chance
// behind it, and before it
//   WALK_KIND     what adds up the light that is scattered: WALK_TETS, WALK_VERTICES or WALK_CORNERS
// It may define
//   WALK_TOWARDS  where power is added up by its direction, as TransportForwardRef has it; or null
#ifndef QUADGRAPH_WALK_RAY_GLSL
#define QUADGRAPH_WALK_RAY_GLSL

#ifndef WALK_KIND
#error "walk_ray.glsl: WALK_KIND is not defined"
#endif

#include "source/fixed_point.glsl"
#include "source/inner_surface.glsl"
#include "source/light_ray.glsl"
#include "source/walk_shared.h"

// Scattered towards the corners of a tet, by channel.
struct Scattered {
  vec4 red, green, blue;
};

vec3 at_corner(Scattered scattered, uint place) {
  return vec3(scattered.red[place], scattered.green[place], scattered.blue[place]);
}

// `power` at the mean place of each channel between the ray's point and `l`, on its way to the vertices in `pending`.
void scatter(TetPoint at, vec3 power, vec4 l, vec3 place, inout Scattered pending) {
  if (WALK_KIND == WALK_TETS) {
    add_power(push.deposit, at.tet, power);
    return;
  }
  Scattered here = Scattered(power.x * mix(at.l, l, place.x), power.y * mix(at.l, l, place.y),
                             power.z * mix(at.l, l, place.z));
  if (WALK_KIND == WALK_VERTICES) {
    pending.red += here.red;
    pending.green += here.green;
    pending.blue += here.blue;
  } else {
    for (uint k = 0u; k < 4u; ++k) add_power(push.deposit, 4u * at.tet + k, at_corner(here, k));
  }
}

// Power that a ray scatters for the first time in its tet, by its direction.
void scatter_along(Ray ray, vec3 power) {
#ifdef WALK_TOWARDS
  if (uvec2(WALK_TOWARDS) == uvec2(0)) return;
  for (uint axis = 0u; axis < 3u; ++axis) {
    add_power(WALK_TOWARDS, 3u * ray.at.tet + axis, (0.5 + 0.5 * clamp(ray.direction[axis], -1.0, 1.0)) * power);
  }
#endif
}

// What the present tet takes from the ray: the exact integral of sigma_s' e^-tau against the basis functions along the
// way to `l`, the rest absorbed.
void cross_tet(inout Ray ray, Optical optical, float length, vec4 l, inout Scattered pending) {
  vec3 lost, place;
  attenuate(extinction(optical) * length, lost, place);
  // The power that is taken is what its float loses, and the difference is carried: the sum over many tets is then exact.
  precise vec3 wanted = ray.power * lost + ray.carry;
  precise vec3 remaining = ray.power - clamp(wanted, vec3(0), ray.power);
  precise vec3 taken = ray.power - remaining;
  ray.carry = wanted - taken;
  ray.power = remaining;
  vec3 scattered = taken * albedo(optical);
  absorbed += taken - scattered;
  scatter(ray.at, scattered, l, place, pending);
  scatter_along(ray, scattered);
}

// Leaves all power at the ray's point; in a clear channel it counts as unscattered.
void end_here(Ray ray, inout Scattered pending) {
  Optical optical = optical_in(ray.at.tet);
  bvec3 clear = equal(extinction(optical), vec3(0));
  vec3 kept = mix(ray.power, vec3(0), clear);
  vec3 scattered = kept * albedo(optical);
  absorbed += kept - scattered;
  unscattered += ray.power - kept;
  scatter(ray.at, scattered, ray.at.l, vec3(0), pending);
  scatter_along(ray, scattered);
}

// Adds what is pending for a vertex to its deposit.
void flush(uint tet, uint place, Scattered pending) {
  if (WALK_KIND != WALK_VERTICES) return;
  add_power(push.deposit, BODY.tets.at[tet][place], at_corner(pending, place));
}

// What is still pending behind a crossing, but for the corner at `place`, which is left.
void carry_on(inout Scattered pending, uint place, uint crossing) {
  pending.red = onward(without(pending.red, place), crossing);
  pending.green = onward(without(pending.green, place), crossing);
  pending.blue = onward(without(pending.blue, place), crossing);
}

// Of its power, with which a ray that begins here ends. Where much is absorbed, what has not scattered reaches as deep
// as what has, so that it is followed in motion as at rest.
vec3 end_share(Optical optical) {
  if ((push.deposits & (WALK_TO_MEAN | WALK_TO_AGAIN)) == 0u) return vec3(WALK_END);
  float sooner = (push.deposits & WALK_TO_AGAIN) != 0u ? WALK_END_AGAIN : WALK_END_MEAN;
  return mix(vec3(WALK_END), vec3(sooner), greaterThan(albedo(optical), vec3(WALK_PALE)));
}

// At an outside face from inside.
void meet_surface(inout Ray ray, uint face);

// Even in [0, 1).
float next_chance();

// Whether the ray goes into the tet across the face opposite a corner; else it is mirrored there.
bool passes(inout Ray ray, uint place, uint across) {
  if (!bends(ray.at.tet, across) || goes_through(ray.at.tet, place, across, next_chance(), ray.direction)) return true;
  bar(ray.at, place);
  return false;
}

// Follows a ray until its light is spent; returns how many tets it crossed.
uint walk(Ray ray) {
  vec3 end = end_share(optical_in(ray.at.tet)) * ray.power;
  Scattered pending = Scattered(vec4(0), vec4(0), vec4(0));
  uint crossed = 0u;
  while (crossed < MAX_WALK_STEPS) {
    Exit exit = find_exit(ray.at, ray.direction);
    if (!exit.found) break;
    ++crossed;
    Optical optical = optical_in(ray.at.tet);
    vec4 l = exit_point(ray.at, exit);
    cross_tet(ray, optical, ray.slope * exit.path, l, pending);
    ray.at.l = l;
    bool spent = all(lessThanEqual(ray.power, end));
    if (spent && extinction(optical) != vec3(0)) break;
    uint crossing = crossing_at(ray.at.tet, exit.place), across = crossing >> CROSSING_BITS;
    if (across < BODY.tet_count) {
      if (!passes(ray, exit.place, across)) continue;
      flush(ray.at.tet, exit.place, pending);
      carry_on(pending, exit.place, crossing);
      enter(ray.at, exit.place, crossing);
    } else {
      bar(ray.at, exit.place);
      meet_surface(ray, across - BODY.tet_count);
      if (ray.power == vec3(0)) break;
    }
  }
  end_here(ray, pending);
  for (uint k = 0u; k < 4u; ++k) flush(ray.at.tet, k, pending);
  return crossed;
}

#endif
