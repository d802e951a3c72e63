#version 460
#extension GL_GOOGLE_include_directive : require
#include "transport/transport_shared.h"
#include "source/fixed_point.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// Fluence by the transport equation at every point, less what the solve has there, as a load on the vertices.
struct TransportSweepPush {
  TransportFieldRefs field;  // one
  Uints drawn;               // one: how many points there are
  TransportPoints points;
  Vec3s fluence;         // that is seen, at the vertices
  Vec3s fluence_before;  // of the field before, where rays see that one too
  Uints sums;  // fixed point, WALK_SUMS times two per half: power that is found, added, then taken away
  Uints load;  // fixed point, of each half for all vertices what is added, then what is taken away
  uint room;
  uint directions;
  uint vertex_count;
  uint seed;
};
layout(push_constant, scalar) uniform Block { TransportSweepPush push; };

TransportFieldRef field;
#define FIELD field
#include "transport/transport_ray.glsl"

#include "transport/sampling.glsl"

// Mean over directions that are turned so. Chance begins at `seed`. `before` as in arriving.
vec3 transported(TetPoint at, vec3 turn, uint seed, out vec3 before) {
  Directions spread = turned_by(turn);
  Ray rays[ABREAST];
  Way ways[ABREAST];
  uint count = 0u;
  while (count < min(ABREAST, push.directions)) rays[count++] = next_ray(at, seed, spread);
  vec3 sum = vec3(0);
  before = vec3(0);
  while (count > 0u) {
    for (uint j = 0u; j < count; ++j) ways[j] = across_tet(rays[j], sum, before);
    for (uint j = count; j-- > 0u;) {
      if (goes_on(rays[j], ways[j], sum, before)) continue;
      if (spread.next < push.directions) {
        rays[j] = next_ray(at, seed, spread);
      } else {
        rays[j] = rays[--count];
      }
    }
  }
  before /= float(push.directions);
  return sum / float(push.directions);
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  field = push.field.at[0];
  crossed = 0u;
  if (i >= min(push.drawn.at[0], push.room)) return;
  TransportPoint point = push.points.at[i];
  Place place = place_of(point);
  uvec4 ids = BODY.tets.at[point.tet];
  vec3 solved = vec3(0), solved_before = vec3(0);
  for (uint k = 0u; k < 4u; ++k) {
    solved += place.l[k] * push.fluence.at[ids[k]];
    if (sees_before()) solved_before += place.l[k] * push.fluence_before.at[ids[k]];
  }
  vec3 before, now = transported(TetPoint(point.tet, place.l, vec4(0)), place.turn, place.seed, before);
  Optical optical = optical_in(point.tet);
  vec3 found = point.volume * (now - solved), load = optical.sigma_s_prime * found;
  vec3 sum = load + optical.sigma_a * found;
  if (sees_before()) {
    Optical then = optical_before(point.tet);
    vec3 known = point.volume * (before - solved_before);
    load -= then.sigma_s_prime * known;
    sum -= (then.sigma_s_prime + then.sigma_a) * known;
  }
  add_signed(push.sums, 2u * (WALK_SUMS * point.half_of + point.tet % WALK_SUMS), 1u, sum);
  uint first = 2u * point.half_of * push.vertex_count;
  for (uint k = 0u; k < 4u; ++k) {
    add_signed(push.load, first + ids[k], push.vertex_count, place.l[k] * load);
  }
  atomicAdd(field.segments.at[0], crossed);
}
