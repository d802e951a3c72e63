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
  Boundaries boundaries;  // by body
  Vec3s q;
  Scales scale;
  RightHandSideRef side;
  uint count;
  uint tet_count;
};
layout(push_constant, scalar) uniform Block { RightHandSideFvPush push; };

// area q at surface node `face`.
vec3 surface_load(uint face) {
  if (!is_open(push.face_kinds, face)) return vec3(0);
  uvec3 corners = push.faces.at[face];
  vec3 p = push.vertices.at[corners.x];
  float area = 0.5 * length(cross(push.vertices.at[corners.y] - p, push.vertices.at[corners.z] - p));
  return area * push.q.at[face] * push.scale.at[0].inverse;
}

void main() {
  vec3 square = vec3(0);
  EACH(i, push.count) {
    vec3 load = vec3(0);
    uint body = 0u;
    if (i >= push.tet_count) {
      load = surface_load(i - push.tet_count);
      body = body_behind(push.face_kinds, i - push.tet_count);
    }
    square += store_b(push.side, i, diffuse_source(push.boundaries.at[body], load));
  }
  store_norm(push.side, square);
}
