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
  Vec3s q;
  Scales scale;
  RightHandSideRef side;
  uint count;
  uint surface_count;
  Boundary boundary;
};
layout(push_constant, scalar) uniform Block { RightHandSideFemPush push; };

// Integral of q against the basis function of surface vertex i: a third of each of its open faces.
vec3 surface_load(uint i) {
  vec3 sum = vec3(0), inverse = push.scale.at[0].inverse;
  for (uint k = push.face_offset.at[i]; k < push.face_offset.at[i + 1u]; ++k) {
    uint face = push.face_incidence.at[k];
    uvec3 corners = push.faces.at[face];
    vec3 p = push.vertices.at[corners.x];
    float area = 0.5 * length(cross(push.vertices.at[corners.y] - p, push.vertices.at[corners.z] - p));
    sum += push.q.at[face] * inverse * area;
  }
  return sum / 3.0;
}

void main() {
  vec3 square = vec3(0);
  EACH(i, push.count) {
    vec3 load = i < push.surface_count ? surface_load(i) : vec3(0);
    square += store_b(push.side, i, diffuse_source(push.boundary, load));
  }
  store_norm(push.side, square);
}
