#version 460
#extension GL_GOOGLE_include_directive : require
#include "transport/transport_shared.h"
#include "source/fixed_point.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// As transport_sweep.comp where light scatters forwards: fluence and flux at every point, less what the solve has there.
struct TransportSweepForwardPush {
  TransportFieldRefs field;      // one
  TransportForwardRefs forward;  // one
  Uints drawn;                   // one: how many points there are
  TransportPoints points;
  Vec3s fluence;  // that is seen, at the vertices
  Vec3s flux;     // the same
  Uints sums;     // fixed point, as of TransportSweepPush
  Uints load;     // the same
  Uints found;    // fixed point, as of TransportFluxLoadPush
  uint room;
  uint directions;
  uint seed;
};
layout(push_constant, scalar) uniform Block { TransportSweepForwardPush push; };

TransportFieldRef field;
TransportForwardRef forward;
#define FIELD field
#define FORWARD forward
#include "transport/forward.glsl"
#include "transport/transport_ray.glsl"
#include "transport/sampling.glsl"

// Fluence and flux by the transport equation.
struct Transported {
  vec3 fluence;
  mat3 flux;
};

// Mean over directions that are turned so. Chance begins at `seed`.
Transported transported(TetPoint at, vec3 turn, uint seed) {
  Directions spread = turned_by(turn);
  Ray rays[ABREAST];
  Way ways[ABREAST];
  vec3 back[ABREAST], sums[ABREAST], unseen = vec3(0);
  uint count = 0u;
  for (; count < min(ABREAST, push.directions); ++count) {
    rays[count] = next_ray(at, seed, spread);
    back[count] = rays[count].direction;
    sums[count] = vec3(0);
  }
  Transported found = Transported(vec3(0), mat3(0.0));
  while (count > 0u) {
    for (uint j = 0u; j < count; ++j) ways[j] = across_tet(rays[j], sums[j], unseen);
    for (uint j = count; j-- > 0u;) {
      if (goes_on(rays[j], ways[j], sums[j], unseen)) continue;
      found.fluence += sums[j];
      found.flux += outerProduct(sums[j], -back[j]);
      if (spread.next < push.directions) {
        rays[j] = next_ray(at, seed, spread);
        back[j] = rays[j].direction;
        sums[j] = vec3(0);
      } else {
        rays[j] = rays[--count];
        back[j] = back[count];
        sums[j] = sums[count];
      }
    }
  }
  float share = 1.0 / float(push.directions);
  return Transported(share * found.fluence, share * found.flux);
}

Transported solved_at(uvec4 ids, vec4 l) {
  Transported sum = Transported(vec3(0), mat3(0.0));
  for (uint k = 0u; k < 4u; ++k) {
    sum.fluence += l[k] * push.fluence.at[ids[k]];
    sum.flux += l[k] * flux_at(push.flux, ids[k]);
  }
  return sum;
}

void add_loads(TransportPoint point, vec4 l, vec3 load, mat3 flux) {
  uvec4 ids = forward.tets.at[point.tet];
  uint count = forward.vertex_count, first = 2u * point.half_of * count;
  for (uint k = 0u; k < 4u; ++k) {
    add_signed(push.load, first + ids[k], count, l[k] * load);
    for (uint axis = 0u; axis < 3u; ++axis) {
      add_signed(push.found, 2u * axis * count + ids[k], count, l[k] * flux[axis]);
    }
  }
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  field = push.field.at[0];
  forward = push.forward.at[0];
  crossed = 0u;
  if (i >= min(push.drawn.at[0], push.room)) return;
  TransportPoint point = push.points.at[i];
  Place place = place_of(point);
  Transported now = transported(TetPoint(point.tet, place.l, vec4(0)), place.turn, place.seed);
  Transported solved = solved_at(forward.tets.at[point.tet], place.l);
  Optical o = optical_of(point.tet);
  vec3 found = point.volume * (now.fluence - solved.fluence), load = o.sigma_s_prime * found;
  mat3 flux = scaled_by(point.volume * o.sigma_s_prime, now.flux - solved.flux);
  uint at = 2u * (WALK_SUMS * point.half_of + point.tet % WALK_SUMS);
  add_signed(push.sums, at, 1u, load + o.sigma_a * found);
  add_loads(point, place.l, load, flux);
  atomicAdd(field.segments.at[0], crossed);
}
