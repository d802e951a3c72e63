#version 460
#extension GL_GOOGLE_include_directive : require
#include "source/walk_shared.h"
#include "material/fresnel.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { WalkSourcePush push; };

#define BODY push.body
#include "source/walk_ray.glsl"
#include "source/walk_start.glsl"

// At an outside face from inside: part leaves, the rest goes on mirrored.
void meet_surface(inout Ray ray, uint face, vec3 outward) {
  vec3 n = outward / length(outward);
  float cosine = dot(ray.direction, n);
  if (BODY.face_kinds.at[face] == FACE_OPEN) {
    vec3 reflected = ray.power * internal_reflectance(cosine, BODY.eta);
    vec3 leaving = ray.power - reflected;
    unscattered += leaving;
    add_power(push.unscattered, face, leaving);
    ray.power = reflected;
  }
  ray.direction = normalize(ray.direction - 2.0 * cosine * n);
}

void follow(BeamRecord way, uint ray, uint face, Frame at, vec3 power) {
  walk(start(way, ray, BODY.face_tets.at[face], at, power));
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  absorbed = vec3(0);
  unscattered = vec3(0);
  if (i >= BODY.face_count * push.rays) return;
  walk_from(i % BODY.face_count, i / BODY.face_count);
  // In turn, so that invocations seldom wait for each other.
  uint at = 2u * (gl_WorkGroupID.x % WALK_SUMS);
  add_power(push.sums, at, absorbed);
  add_power(push.sums, at + 1u, unscattered);
}
