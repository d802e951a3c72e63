#version 460
#extension GL_GOOGLE_include_directive : require
#include "assemble/assembly_shared.h"
#include "material/optics.h"
#include "solver/right_hand_side.glsl"

// Scaled b at every node, and its norm.
struct RightHandSideFvPush {
  Vec3s vertices;
  Uvec3s faces;
  Uints face_kinds;
  Vec3s q;
  Scales scale;
  RightHandSideRef side;
  uint count;
  uint tet_count;
  Boundary boundary;
};
layout(push_constant, scalar) uniform Block { RightHandSideFvPush push; };

// area q at surface node `face`.
vec3 surface_load(uint face) {
  if (push.face_kinds.at[face] != FACE_OPEN) return vec3(0);
  uvec3 corners = push.faces.at[face];
  vec3 p = push.vertices.at[corners.x];
  float area = 0.5 * length(cross(push.vertices.at[corners.y] - p, push.vertices.at[corners.z] - p));
  return area * push.q.at[face] * push.scale.at[0].inverse;
}

void main() {
  vec3 square = vec3(0);
  EACH(i, push.count) {
    vec3 load = i < push.tet_count ? vec3(0) : surface_load(i - push.tet_count);
    square += store_b(push.side, i, diffuse_source(push.boundary, load));
  }
  store_norm(push.side, square);
}
