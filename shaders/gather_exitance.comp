#version 460
#extension GL_GOOGLE_include_directive : require
#include "gather_shared.h"
#include "fresnel.glsl"
#include "face_azimuth.glsl"
#include "lambertian.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { GatherExitancePush push; };

BodyRef body;
#define BODY body
#define POINTS push.points
#include "gather.glsl"

const float PI = 3.14159265;

// Radiance at the Gauss nodes of the outside cosine. The body is taken as layered along the ray that goes straight in:
// there a slanted ray sees the same at 1 / cosine times the depth.
vec3 radiance[LAMBERTIAN_NODES];
vec3 left[LAMBERTIAN_NODES];

// Adds what lies between two points of the present tet. Returns whether any ray goes on.
bool cross_tet(Lambertian nodes, GatherPoint from, GatherPoint to, float path) {
  bool on = false;
  for (uint k = 0u; k < LAMBERTIAN_NODES; ++k) {
    float length = path / nodes.cosine[k];
    vec3 lost, fluence = fluence_along(from, to, extinction() * length, lost);
    vec3 last = left[k] * optical.sigma_s_prime * (length / FOUR_PI) * fluence;
    radiance[k] += last;
    left[k] -= left[k] * lost;
    on = on || !ends(left[k], radiance[k], last, lost);
  }
  return on;
}

// Returns whether light comes straight through the body.
bool gather_straight(uint tet, vec3 direction, Lambertian nodes) {
  bool thin = false;
  GatherPoint here = fields_here();
  for (uint step = 0u; step < GATHER_STEPS; ++step) {
    Exit exit = find_exit(direction);
    if (!exit.found) break;
    vec4 l = exit_point(exit);
    GatherPoint there = fields_at(l);
    bool on = cross_tet(nodes, here, there, exit.path);
    here = there;
    move_to(l);
    if (!on) break;
    uvec2 crossing = turn(tet, exit.slot);
    if (crossing.x < BODY.tet_count) {
      tet = crossing.x;
      enter(crossing);
      continue;
    }
    vec3 n = exit.outward / length(exit.outward);
    if (load_uint(BODY.face_kinds, crossing.x - BODY.tet_count) == FACE_OPEN) {
      thin = thin || any(greaterThan(left[LAMBERTIAN_NODES - 1u], vec3(GATHER_END)));
      for (uint k = 0u; k < LAMBERTIAN_NODES; ++k) left[k] *= internal_reflectance(nodes.cosine[k], BODY.eta);
      if (BODY.eta == 1.0) break;
    }
    direction = normalize(direction - 2.0 * dot(direction, n) * n);
  }
  for (uint k = 0u; k < LAMBERTIAN_NODES; ++k) radiance[k] += left[k] * even_radiance(here);
  return thin;
}

// Where a body is so thin that its other side counts, slanted rays go where they go.
void gather_slanted(uint tet, uvec3 ids, mat3 corners, vec3 normal, vec3 tangent) {
  for (uint k = 0u; k < LAMBERTIAN_NODES; ++k) radiance[k] = vec3(0);
  for (uint ray = 0u; ray < 2u * LAMBERTIAN_NODES; ++ray) {
    start_on_face(tet, ids, corners, vec3(1.0 / 3.0));
    vec3 incoming = lambertian_incoming(ray, normal, tangent);
    radiance[ray / 2u] += 0.5 * gather(tet, refracted(incoming, normal, BODY.eta)).radiance;
  }
}

void main() {
  uint face = gl_GlobalInvocationID.x;
  body = load_body(push.body);
  if (face >= BODY.face_count) return;
  push.exitance.at[face] = vec3(0);
  if (load_uint(BODY.face_kinds, face) != FACE_OPEN) return;
  for (uint k = 0u; k < LAMBERTIAN_NODES; ++k) {
    radiance[k] = vec3(0);
    left[k] = vec3(1);
  }
  uvec3 ids = load_uvec3(BODY.faces, face);
  mat3 corners = corners_of(ids);
  vec3 normal = normalize(cross(corners[1] - corners[0], corners[2] - corners[0]));
  uint tet = load_uint(BODY.face_tets, face);
  start_on_face(tet, ids, corners, vec3(1.0 / 3.0));
  if (gather_straight(tet, -normal, lambertian(BODY.eta))) {
    gather_slanted(tet, ids, corners, normal, face_tangent(face, normal, corners[1] - corners[0]));
  }
  vec3 exitance = vec3(0);
  for (uint k = 0u; k < LAMBERTIAN_NODES; ++k) {
    exitance += LAMBERTIAN_W[k] * fresnel_transmittance(sqrt(LAMBERTIAN_U[k]), BODY.eta) * radiance[k];
  }
  push.exitance.at[face] = PI / (BODY.eta * BODY.eta) * exitance;
}
