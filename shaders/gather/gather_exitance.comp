#version 460
#extension GL_GOOGLE_include_directive : require
#include "gather/gather_shared.h"
#include "source/face_azimuth.glsl"
#include "source/lambertian.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// Exitance of what is gathered, per face.
struct GatherExitancePush {
  SolidRefs solid;  // one
  GatherPoints points;
  Vec3s exitance;  // W/mm^2, written
  GatherScales scale;  // null: what is gathered counts as it is
  uint through;        // 1: with what other parts of the body send through this one, as the exitance of a correction has it
};
layout(push_constant, scalar) uniform Block { GatherExitancePush push; };

SolidRef solid;
#define BODY solid.body
#define TREE_BODY solid.body
#define TREE solid.tree
#define NORMALS solid.normals
#define FORWARD_LIGHT solid.forward
#define POINTS push.points
#include "gather/leaving.glsl"

const float PI = 3.14159265;

void main() {
  uint face = gl_GlobalInvocationID.x;
  solid = push.solid.at[0];
  if (face >= BODY.face_count) return;
  push.exitance.at[face] = vec3(0);
  if (!is_open(BODY.face_kinds, face)) return;
  uvec3 ids = BODY.faces.at[face];
  mat3 corners = corners_of(ids);
  vec3 doubled = cross(corners[1] - corners[0], corners[2] - corners[0]);
  if (doubled == vec3(0)) return;
  vec3 normal = normalize(doubled);
  vec3 tangent = face_tangent(face, normal, corners[1] - corners[0]);
  bool through = push.through == 1u;
  uint parts = through ? VIEW_PARTS : 1u;
  GatherScales scale = through ? push.scale : GatherScales(uvec2(0));
  OpticalSurface surface = surface_of(BODY.face_kinds, face);
  vec3 exitance = vec3(0);
  for (uint node = 0u; node < LAMBERTIAN_NODES; ++node) {
    vec3 incoming = lambertian_incoming(2u * node + (node >> 1u), normal, tangent);
    float lets_out = surface_transmittance(sqrt(LAMBERTIAN_U[node]), surface);
    Facets facets = Facets(surface.roughness, hash(face), node, 0u, lets_out);
    exitance += LAMBERTIAN_W[node] * leaving(face, vec3(1.0 / 3.0), -incoming, normal, scale, facets, parts).radiance;
  }
  push.exitance.at[face] = PI * exitance;
}
