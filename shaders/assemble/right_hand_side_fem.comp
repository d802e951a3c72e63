#version 460
#extension GL_GOOGLE_include_directive : require
#include "assemble/assembly_shared.h"
#include "material/optics.h"
#include "solver/right_hand_side.glsl"

// Scaled b at every vertex, and its norm.
struct RightHandSideFemPush {
  Vec3s vertices;
  Uvec3s faces;
  Uints face_offset;
  Uints face_incidence;
  Uints face_kinds;
  Boundaries boundaries;  // by body; null: light is scattered at the surface itself
  Vec3s q;
  Scales scale;
  RightHandSideRef side;
  uint count;
  uint surface_count;
};
layout(push_constant, scalar) uniform Block { RightHandSideFemPush push; };

// Integral of q against the basis function of surface vertex i: a third of each of its open faces.
vec3 surface_load(uint i, out uint body) {
  body = 0u;
  vec3 sum = vec3(0), inverse = push.scale.at[0].inverse;
  for (uint k = push.face_offset.at[i]; k < push.face_offset.at[i + 1u]; ++k) {
    uint face = push.face_incidence.at[k];
    uvec3 corners = push.faces.at[face];
    vec3 p = push.vertices.at[corners.x];
    float area = 0.5 * length(cross(push.vertices.at[corners.y] - p, push.vertices.at[corners.z] - p));
    sum += push.q.at[face] * inverse * area;
    body = body_behind(push.face_kinds, face);
  }
  return sum / 3.0;
}

void main() {
  vec3 square = vec3(0);
  EACH(i, push.count) {
    uint body = 0u;
    vec3 load = i < push.surface_count ? surface_load(i, body) : vec3(0);
    Boundary boundary = Boundary(1.0, 0.0, 0.0, 1.0, 0.0);
    if (uvec2(push.boundaries) != uvec2(0)) boundary = push.boundaries.at[body];
    square += store_b(push.side, i, diffuse_source(boundary, load));
  }
  store_norm(push.side, square);
}
