// Light that reaches a point along a ray, back to where it scattered last. The shader that includes it defines first
//   FIELD  where the TransportFieldRef is
// and, where rays are few and what is dim is to be told well,
//   LEAST_LEFT  what a ray keeps at least, in place of TRANSPORT_ROULETTE
#ifndef QUADGRAPH_TRANSPORT_RAY_GLSL
#define QUADGRAPH_TRANSPORT_RAY_GLSL

#include "transport/transport_shared.h"

#ifndef FIELD
#error "transport_ray.glsl: FIELD is not defined"
#endif

#ifndef LEAST_LEFT
#define LEAST_LEFT TRANSPORT_ROULETTE
#endif

#define BODY FIELD.body
#define RAYS_ABREAST
#include "transport/transport_surface.glsl"

const float GOLDEN_ANGLE = 2.3999632;
const float TWO_PI = 6.2831853;

uint crossed;  // tets, by this invocation's rays

struct Ray {
  TetPoint at;
  vec3 direction;
  vec3 left;         // of 1, on the way so far
  vec3 left_before;  // the same in the body before
  uint state;        // of its random numbers
  uint steps;        // tets so far
};

// Where a ray leaves the tet that it has crossed.
struct Way {
  bool found;  // false where the ray ends in it
  uint place;  // of the corner opposite
  uint crossing;
  vec3 ahead;  // what would come from beyond if all were there as it is here
  vec3 ahead_before;
};

bool sees_before() {
  return uvec2(FIELD.source_before) != uvec2(0);
}

bool goes_forward() {
  return uvec2(FIELD.flows) != uvec2(0);
}

Ray ray_from(TetPoint at, vec3 direction, uint state) {
  return Ray(at, direction, vec3(1), vec3(sees_before() ? 1.0 : 0.0), state, 0u);
}

float largest(vec3 v) {
  return max(v.x, max(v.y, v.z));
}

Optical optical_before(uint tet) {
  return FIELD.optical_before.at[FIELD.even_before != 0u ? 0u : tet];
}

vec3 source_before_at(uint tet, vec4 l) {
  vec3 source = vec3(0);
  for (uint k = 0u; k < 4u; ++k) source += l[k] * FIELD.source_before.at[4u * tet + k];
  return source;
}

// Along x, y and z, times a direction of travel.
vec3 flow_along(uint at, vec3 travels) {
  return travels.x * FIELD.flows.at[at] + travels.y * FIELD.flows.at[at + 1u] + travels.z * FIELD.flows.at[at + 2u];
}

// By how much a tet scatters more for the first time in a direction than its flows say, as a share of what it scatters.
vec3 first_beyond(uint at, vec3 travels) {
  vec3 x = FIELD.flows.at[at], y = FIELD.flows.at[at + 1u], z = FIELD.flows.at[at + 2u];
  vec3 straight = sqrt(x * x + y * y + z * z);
  return straight * beyond_linear(FIELD.beside, flow_along(at, travels) / max(straight, vec3(1e-6)));
}

// What a tet scatters at its corners in a direction of travel.
TetSource light_of(uint tet, vec3 travels) {
  TetSource light = FIELD.sources.at[tet];
  if (!goes_forward()) return light;
  uint at = FLOWS * tet, first = at + FLOWS_FIRST;
  vec3 a = FIELD.flows.at[first], b = FIELD.flows.at[first + 1u], c = FIELD.flows.at[first + 2u],
       d = FIELD.flows.at[first + 3u], more = vec3(0);
  if (a != vec3(0) || b != vec3(0) || c != vec3(0) || d != vec3(0)) more = first_beyond(at + FLOWS_DIRECTION, travels);
  light.source_0 += vec4(flow_along(at, travels) + more * a, 0.0);
  light.source_1 += vec4(flow_along(at + 3u, travels) + more * b, 0.0);
  light.source_2 += vec4(flow_along(at + 6u, travels) + more * c, 0.0);
  light.source_3 += vec4(flow_along(at + 9u, travels) + more * d, 0.0);
  return light;
}

vec3 at_place(TetSource light, vec4 l) {
  vec4 source = l.x * light.source_0 + l.y * light.source_1 + l.z * light.source_2 + l.w * light.source_3;
  return source.xyz;
}

// Adds the source between two places of a tet `path` apart, attenuated on the way to the ray's start: exact where the
// source is linear. Returns what a ray without end brings where the source is as at the second place.
vec3 add_source(vec3 from, vec3 to, vec3 sigma_t, float path, inout vec3 sum, inout vec3 left) {
  vec3 tau = max(sigma_t * path, vec3(1e-20)), t = min(tau, vec3(0.1));
  vec3 passes = exp(-tau), inverse = 1.0 / tau;
  bvec3 small = lessThan(tau, vec3(0.1));
  // Means over the path of e^-tau s and of s e^-tau s, and series where these cancel.
  vec3 all = mix((1.0 - passes) * inverse,
                 1.0 - t * (1.0 / 2.0 - t * (1.0 / 6.0 - t * (1.0 / 24.0))), small);
  vec3 late = mix((all - passes) * inverse,
                  1.0 / 2.0 - t * (1.0 / 3.0 - t * (1.0 / 8.0 - t * (1.0 / 30.0))), small);
  sum += path * left * (from * all + (to - from) * late);
  left *= passes;
  return path * inverse * to;
}

// Adds the source along the ray in its tet, attenuated on the way to the ray's start, for the field that is seen and the
// one before, and takes the ray to where it leaves that tet. It has no branch, so that several rays can be followed side
// by side.
Way across_tet(inout Ray ray, inout vec3 sum, inout vec3 before) {
  Exit exit = find_exit(ray.at, ray.direction);
  crossed += exit.found ? 1u : 0u;
  float path = exit.found ? exit.path : 0.0;
  uint tet = ray.at.tet;
  vec4 start = ray.at.l, end = exit_point(ray.at, exit);
  TetSource light = light_of(tet, -ray.direction);
  vec3 ahead =
      add_source(at_place(light, start), at_place(light, end), extinction(optical_in(tet)), path, sum, ray.left);
  vec3 ahead_before = vec3(0);
  if (sees_before()) {
    ahead_before = add_source(source_before_at(tet, start), source_before_at(tet, end),
                              extinction(optical_before(tet)), path, before, ray.left_before);
  }
  ray.at.l = end;
  return Way(exit.found, exit.place, crossing_at(tet, exit.place), ahead, ahead_before);
}

// At the surface from inside: on, mirrored or through the air. False where the ray ends.
bool goes_past(uint face, inout Ray ray) {
  vec3 n = outward_normal(face);
  float cosine = clamp(dot(ray.direction, n), 0.0, 1.0);
  if (is_open(BODY.face_kinds, face)) {
    OpticalSurface surface = surface_of(BODY.face_kinds, face);
    float eta = surface.eta, reflected = surface_reflectance_inside(cosine, surface);
    if (!sees_body(face)) {
      ray.left *= reflected;
      ray.left_before *= reflected;
      if (reflected == 0.0) return false;
    } else if (uniform_number(ray.state) >= reflected) {
      Entrance entry = through_air(face, in_space(ray.at), way_on(ray.direction, n, surface, true, ray.state), ray.state);
      if (entry.face == NO_FACE) return false;
      ray.at = entrance_point(entry);
      ray.direction = entry.direction;
      // From one medium to another radiance over the square of the index is kept.
      float there = eta_behind(BODY.face_kinds, entry.face), kept = eta * eta / (there * there);
      ray.left *= kept;
      ray.left_before *= kept;
      return true;
    }
    ray.direction = way_on(ray.direction, n, surface, false, ray.state);
    return true;
  }
  ray.direction = normalize(ray.direction - 2.0 * cosine * n);
  return true;
}

// Whether a ray is kept; by chance, without bias, where little of it is left. What is then added for sure is what the
// source here lets expect of the rest, so that chance has only the difference to that.
bool survives(inout Ray ray, Way way, inout vec3 sum, inout vec3 before) {
  vec3 left = max(ray.left, ray.left_before);
  if (any(greaterThanEqual(left, vec3(LEAST_LEFT)))) return true;
  float most = largest(left), grows = LEAST_LEFT / most;
  bool kept = uniform_number(ray.state) * LEAST_LEFT < most;
  float share = kept ? 1.0 - grows : 1.0;
  sum += share * ray.left * way.ahead;
  before += share * ray.left_before * way.ahead_before;
  ray.left *= grows;
  ray.left_before *= grows;
  return kept;
}

// Into what lies across. False where the ray ends.
bool goes_on(inout Ray ray, Way way, inout vec3 sum, inout vec3 before) {
  if (!way.found || ++ray.steps == MAX_WALK_STEPS) return false;
  uint across = way.crossing >> CROSSING_BITS;
  if (across < BODY.tet_count) {
    if (bends(ray.at.tet, across) &&
        !goes_through(ray.at.tet, way.place, across, uniform_number(ray.state), ray.direction)) {
      bar(ray.at, way.place);
      return survives(ray, way, sum, before);
    }
    enter(ray.at, way.place, way.crossing);
  } else {
    bar(ray.at, way.place);
    if (!goes_past(across - BODY.tet_count, ray)) return false;
  }
  return survives(ray, way, sum, before);
}

// The source along the ray from its point, attenuated on the way to that point: 4 pi times the radiance there, against
// the ray's direction. `before`: that of the field before, where it is seen.
vec3 arriving(Ray ray, out vec3 before) {
  vec3 sum = vec3(0);
  before = vec3(0);
  for (;;) {
    Way way = across_tet(ray, sum, before);
    if (!goes_on(ray, way, sum, before)) return sum;
  }
}

#endif
