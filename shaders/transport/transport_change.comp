#version 460
#extension GL_GOOGLE_include_directive : require
#include "transport/transport_shared.h"
#include "surface/surface_shared.h"
#include "shared/stride.glsl"
#include "shared/reduce.glsl"
#include "shared/face_area.glsl"

// What a sweep has changed at the surface vertices, each with the mean over its open faces, and how far its halves
// differ: J = G + k11 delta times its gain, less the exitance before.
struct TransportChangePush {
  Vec3s vertices;
  Uvec3s faces;
  Uints face_offset;
  Uints face_incidence;
  SurfaceShares share;
  Boundaries boundaries;  // of the correction, by body
  Scales scale;
  Vec3s gathered;  // of transport_exitance.comp
  Vec3s change_a;  // fluence at the vertices that the solves of both halves add
  Vec3s change_b;
  TransportBooks books;
  Vec3s before;  // exitance of both halves before the sweep, W/mm^2
  TransportChanges change;
  Reduction reduction;
  uint count;
  uint face_count;
  uint ahead;   // 1: what the solves add is the change; 0: all that the exitance before lacks
  uint solves;  // 1: the noise is that of the solves alone, which spreads over the body; 0: with that of G
};
layout(push_constant, scalar) uniform Block { TransportChangePush push; };

vec3 at_face(Vec3s field, uint face) {
  uvec3 ids = push.faces.at[face];
  return (field.at[ids.x] + field.at[ids.y] + field.at[ids.z]) / 3.0;
}

void main() {
  mat3 sums = mat3(0.0);  // of change, noise, size
  Scale unit = push.scale.at[0];
  // One factor for all channels, which are weighed alike.
  vec3 colours = unit.scale / max(unit.scale.x, max(unit.scale.y, unit.scale.z));
  EACH(v, push.count) {
    vec3 a = vec3(0), b = vec3(0), before_a = vec3(0), before_b = vec3(0), difference = vec3(0);
    vec3 solved_a = vec3(0), solved_b = vec3(0);
    float around = 0.0;
    vec3 gain = push.boundaries.at[push.share.at[v].body].k11 * push.books.at[0].gain;
    for (uint k = push.face_offset.at[v]; k < push.face_offset.at[v + 1u]; ++k) {
      uint face = push.face_incidence.at[k];
      float area = area_of(push.faces, push.vertices, face);
      around += area;
      vec3 g_a = push.gathered.at[face], g_b = push.gathered.at[push.face_count + face];
      vec3 added_a = gain * at_face(push.change_a, face), added_b = gain * at_face(push.change_b, face);
      solved_a += area * added_a;
      solved_b += area * added_b;
      a += area * (g_a + added_a);
      b += area * (g_b + added_b);
      difference += area * (push.solves == 1u ? added_a - added_b : g_a + added_a - g_b - added_b);
      before_a += area * push.before.at[face];
      before_b += area * push.before.at[push.face_count + face];
    }
    if (around == 0.0) continue;
    vec3 changed_a = a - unit.inverse * before_a, changed_b = b - unit.inverse * before_b;
    if (push.ahead == 1u) changed_a = solved_a, changed_b = solved_b;
    vec3 per_area = colours / around;
    vec3 noise = 0.5 * per_area * difference, size = 0.5 * per_area * (a + b);
    vec3 area = push.share.at[v].area;
    sums[0] += dot(per_area * changed_a, per_area * changed_b) * area;
    sums[1] += dot(noise, noise) * area;
    sums[2] += dot(size, size) * area;
  }
  mat3 all;
  if (!reduce_dispatch_three(push.reduction, sums, all)) return;
  if (gl_LocalInvocationID.x != 0u) return;
  push.change.at[0] = TransportChange(all[0], all[1], all[2]);
}
