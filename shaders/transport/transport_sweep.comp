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

vec3 on_sphere(float z, float azimuth) {
  float s = sqrt(max(1.0 - z * z, 0.0));
  return vec3(s * cos(azimuth), s * sin(azimuth), z);
}

// Uniform in a tet (Rocchini and Cignoni 2000).
vec4 in_tet(float s, float t, float u) {
  if (s + t > 1.0) {
    s = 1.0 - s;
    t = 1.0 - t;
  }
  if (t + u > 1.0) {
    float before = u;
    u = 1.0 - s - t;
    t = 1.0 - before;
  } else if (s + t + u > 1.0) {
    float before = u;
    u = s + t + u - 1.0;
    s = 1.0 - t - before;
  }
  return vec4(1.0 - s - t - u, s, t, u);
}

// Two unit vectors, orthogonal to each other and to the unit vector n (Duff et al. 2017).
void frame_about(vec3 n, out vec3 a, out vec3 b) {
  float side = n.z < 0.0 ? -1.0 : 1.0;
  float c = -1.0 / (side + n.z), d = n.x * n.y * c;
  a = vec3(1.0 + side * n.x * n.x * c, side * d, -side * n.x);
  b = vec3(d, side + n.y * n.y * c, -n.y);
}

// How many rays of a point are followed at a time: a processor goes on with one while it waits for what another needs.
#ifdef QG_PROCESSOR
const uint ABREAST = 4u;
#else
const uint ABREAST = 1u;
#endif

// Directions that are spread evenly, one after the other.
struct Directions {
  vec3 a, b, axis;  // orthonormal
  vec2 azimuth;     // of the next: cosine and sine
  uint next;
};

vec3 next_of(inout Directions spread) {
  float z = 1.0 - (2.0 * float(spread.next++) + 1.0) / float(push.directions), s = sqrt(max(1.0 - z * z, 0.0));
  vec2 d = s * spread.azimuth;
  const vec2 turn = vec2(-0.737368878, 0.675490294);  // by the golden angle
  spread.azimuth = vec2(turn.x * spread.azimuth.x - turn.y * spread.azimuth.y,
                        turn.y * spread.azimuth.x + turn.x * spread.azimuth.y);
  return d.x * spread.a + d.y * spread.b + z * spread.axis;
}

// The same, turned by three numbers in [0, 1).
Directions turned_by(vec3 turn) {
  Directions spread;
  spread.axis = on_sphere(2.0 * turn.x - 1.0, TWO_PI * turn.y);
  frame_about(spread.axis, spread.a, spread.b);
  spread.azimuth = vec2(cos(TWO_PI * turn.z), sin(TWO_PI * turn.z));
  spread.next = 0u;
  return spread;
}

Ray next_ray(TetPoint at, uint seed, inout Directions spread) {
  uint state = hash(seed + spread.next);
  return ray_from(at, next_of(spread), state);
}

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
      if (goes_on(rays[j], ways[j])) continue;
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
  uint start = hash(TRANSPORT_HALVES * point.tet + point.half_of ^ hash(push.seed));
  float u[6];
  for (uint k = 0u; k < 6u; ++k) u[k] = spread_number(start, point.number, k);
  vec4 l = in_tet(u[0], u[1], u[2]);
  uvec4 ids = BODY.tets.at[point.tet];
  vec3 solved = vec3(0), solved_before = vec3(0);
  for (uint k = 0u; k < 4u; ++k) {
    solved += l[k] * push.fluence.at[ids[k]];
    if (sees_before()) solved_before += l[k] * push.fluence_before.at[ids[k]];
  }
  uint seed = hash(start + point.number);
  vec3 before, now = transported(TetPoint(point.tet, l, vec4(0)), vec3(u[3], u[4], u[5]), seed, before);
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
    add_signed(push.load, first + ids[k], push.vertex_count, l[k] * load);
  }
  atomicAdd(field.segments.at[0], crossed);
}
