// Light that reaches a point along a ray, back to where it scattered last. The shader that includes it defines first
//   FIELD  where the TransportFieldRef is
#ifndef QUADGRAPH_TRANSPORT_RAY_GLSL
#define QUADGRAPH_TRANSPORT_RAY_GLSL

#include "material/fresnel.glsl"
#include "transport/random.glsl"
#include "transport/transport_shared.h"

#ifndef FIELD
#error "transport_ray.glsl: FIELD is not defined"
#endif

struct Payload {
  vec3 fluence;
};

Payload payload(uint id) {
  return Payload(FIELD.fluence.at[id]);
}

#define BODY FIELD.body
#include "source/tet_ray.glsl"

const float GOLDEN_ANGLE = 2.3999632;

uint crossed;  // tets, by this invocation's rays

// Power per volume that light scatters for the first time, between the corners of the present tet.
struct FirstScattered {
  vec3 at_0, at_1, at_2, at_3;
};

FirstScattered first_scattered(uint tet) {
  return FirstScattered(FIELD.first.at[4u * tet + corner_0.place], FIELD.first.at[4u * tet + corner_1.place],
                        FIELD.first.at[4u * tet + corner_2.place], FIELD.first.at[4u * tet + corner_3.place]);
}

vec3 fluence_at(vec4 l) {
  return l.x * corner_0.payload.fluence + l.y * corner_1.payload.fluence + l.z * corner_2.payload.fluence +
         l.w * corner_3.payload.fluence;
}

// All light that is scattered, per volume.
vec3 source_at(FirstScattered first, vec4 l) {
  return optical.sigma_s_prime * fluence_at(l) + l.x * first.at_0 + l.y * first.at_1 + l.z * first.at_2 +
         l.w * first.at_3;
}

float largest(vec3 v) {
  return max(v.x, max(v.y, v.z));
}

// At the surface from inside: what is mirrored of `left` goes on.
void mirror(uint face, vec3 outward, inout vec3 direction, inout vec3 left) {
  vec3 n = outward / length(outward);
  float cosine = dot(direction, n);
  if (BODY.face_kinds.at[face] == FACE_OPEN) left *= internal_reflectance(cosine, BODY.eta);
  direction = normalize(direction - 2.0 * cosine * n);
}

// Whether a ray goes on that keeps `left`; by chance, without bias, where that is little.
bool goes_on(inout vec3 left, inout uint state) {
  float most = largest(left);
  if (most >= TRANSPORT_ROULETTE) return true;
  if (uniform_number(state) * TRANSPORT_ROULETTE >= most) return false;
  left *= TRANSPORT_ROULETTE / most;
  return true;
}

// The source along the ray that goes from its point into the body, attenuated on the way to that point: 4 pi times the
// radiance there, against `direction`.
vec3 arriving(uint tet, vec3 direction, inout uint state) {
  vec3 sum = vec3(0), left = vec3(1);
  for (uint step = 0u; step < MAX_WALK_STEPS; ++step) {
    Exit exit = find_exit(direction);
    if (!exit.found) break;
    ++crossed;
    vec4 l = exit_point(exit);
    FirstScattered first = first_scattered(tet);
    vec3 here = source_at(first, vec4(corner_0.l, corner_1.l, corner_2.l, corner_3.l)), lost;
    sum += left * exit.path * attenuated_mean(here, source_at(first, l), extinction() * exit.path, lost);
    left -= left * lost;
    move_to(l);
    uvec2 crossing = turn(tet, exit.slot);
    if (crossing.x < BODY.tet_count) {
      tet = crossing.x;
      enter(crossing);
    } else {
      mirror(crossing.x - BODY.tet_count, exit.outward, direction, left);
    }
    if (!goes_on(left, state)) break;
  }
  return sum;
}

#endif
