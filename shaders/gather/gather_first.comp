#version 460
#extension GL_GOOGLE_include_directive : require
#include "gather/gather_shared.h"
#include "gather/tet_quadrature.h"
#include "transport/first_scattered.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// Light that scatters for the first time: what the rays of a correction brought to a tet (transport_walk.comp), less what
// the points have of it. These know of one way to the surface; rays come from everywhere and go through parts of a body.
struct GatherFirstPush {
  SolidRefs solid;  // one
  GatherPoints points;
  Uints deposit;  // fixed point, at the corners of the tets, four each, scaled: power scattered for the first time
  Scales scale;
  Vec3s lacking;  // W, written: the same places
  uint count;
};
layout(push_constant, scalar) uniform Block { GatherFirstPush push; };

SolidRef solid;
#define BODY solid.body
#define POINTS push.points
#include "gather/gather_fields.glsl"

// Beside light that has scattered, less of the other than this share counts as none.
const float GATHER_FAINT = 1e-3;

float largest(vec3 v) {
  return max(v.x, max(v.y, v.z));
}

// At the corners of a tet.
struct Corners {
  GatherPoint a, b, c, d;
};

// Whether these have light of that kind.
bool lit(Corners at) {
  vec4 first = max(max(at.a.uncollided, at.b.uncollided), max(at.c.uncollided, at.d.uncollided));
  vec4 others = max(max(at.a.phi, at.b.phi), max(at.c.phi, at.d.phi));
  return any(greaterThan(first, GATHER_FAINT * others));
}

// Points along an edge that integrals take.
uint points_for(Corners at) {
  vec4 span = max(max(at.a.depth, at.b.depth), max(at.c.depth, at.d.depth)) -
              min(min(at.a.depth, at.b.depth), min(at.c.depth, at.d.depth));
  float optical = largest(span.xyz);
  return optical <= GAUSS_TWO_UP_TO     ? 2u
         : optical <= GAUSS_THREE_UP_TO ? 3u
         : optical <= GAUSS_FOUR_UP_TO  ? 4u
                                        : 5u;
}

uint first_of(uint points) {
  return points == 2u ? GAUSS_TWO : points == 3u ? GAUSS_THREE : points == 4u ? GAUSS_FOUR : GAUSS_FIVE;
}

vec3 fluence_at(Corners at, vec4 l) {
  vec4 entry = l.x * at.a.entry + l.y * at.b.entry + l.z * at.c.entry + l.w * at.d.entry;
  vec4 depth = l.x * at.a.depth + l.y * at.b.depth + l.z * at.c.depth + l.w * at.d.depth;
  vec4 linear = l.x * at.a.uncollided + l.y * at.b.uncollided + l.z * at.c.uncollided + l.w * at.d.uncollided;
  return held(entry.xyz * exp(-depth.xyz), linear.xyz);
}

// Means of that times the coordinates.
struct Means {
  vec3 a, b, c, d;
};

Means means_of(Corners at) {
  Means sum = Means(vec3(0), vec3(0), vec3(0), vec3(0));
  if (!lit(at)) return sum;
  uint points = points_for(at), first = first_of(points), end = first + points;
  for (uint i = first; i < end; ++i) {
    for (uint j = first; j < end; ++j) {
      for (uint k = first; k < end; ++k) {
        float rest = 1.0 - GAUSS_NODE[i], y = GAUSS_NODE[j] * rest, last = rest - y, z = GAUSS_NODE[k] * last;
        vec4 l = vec4(GAUSS_NODE[i], y, z, last - z);
        float weight = 6.0 * GAUSS_WEIGHT[i] * GAUSS_WEIGHT[j] * GAUSS_WEIGHT[k] * rest * last;
        vec3 fluence = weight * fluence_at(at, l);
        sum.a += l.x * fluence;
        sum.b += l.y * fluence;
        sum.c += l.z * fluence;
        sum.d += l.w * fluence;
      }
    }
  }
  return sum;
}

void main() {
  uint tet = gl_GlobalInvocationID.x;
  if (tet >= push.count) return;
  solid = push.solid.at[0];
  uvec4 ids = BODY.tets.at[tet];
  Means had = means_of(
      Corners(push.points.at[ids.x], push.points.at[ids.y], push.points.at[ids.z], push.points.at[ids.w]));
  vec3 scattered = volume_of(BODY.vertices, ids) * optical_in(tet).sigma_s_prime, unit = push.scale.at[0].scale;
  uint at = 4u * tet;
  push.lacking.at[at] = power_at(push.deposit, at) * unit - scattered * had.a;
  push.lacking.at[at + 1u] = power_at(push.deposit, at + 1u) * unit - scattered * had.b;
  push.lacking.at[at + 2u] = power_at(push.deposit, at + 2u) * unit - scattered * had.c;
  push.lacking.at[at + 3u] = power_at(push.deposit, at + 3u) * unit - scattered * had.d;
}
