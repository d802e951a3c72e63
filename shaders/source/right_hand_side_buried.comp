#version 460
#extension GL_GOOGLE_include_directive : require
#include "source/walk_shared.h"
#include "material/optics.h"
#include "source/fixed_point.glsl"
#include "solver/right_hand_side.glsl"

// Scaled b from the deposits, and its norm. Surface nodes of the graph methods have none.
struct RightHandSideBuriedPush {
  Uints deposit;
  Vec3s vertices;  // those of the tets, where b is power per volume
  Uvec4s tets;
  RightHandSideRef side;
  uint count;
  uint deposit_count;  // elements with a deposit: the first ones
  uint per_volume;     // 1: quadgraph-fdm
};
layout(push_constant, scalar) uniform Block { RightHandSideBuriedPush push; };

float volume_of(uint tet) {
  uvec4 corners = push.tets.at[tet];
  vec3 p = push.vertices.at[corners.x];
  vec3 e1 = push.vertices.at[corners.y] - p, e2 = push.vertices.at[corners.z] - p;
  vec3 e3 = push.vertices.at[corners.w] - p;
  return abs(dot(e1, cross(e2, e3))) / 6.0;
}

void main() {
  vec3 square = vec3(0);
  EACH(i, push.count) {
    vec3 power = i < push.deposit_count ? power_at(push.deposit, i) : vec3(0);
    if (push.per_volume == 1u && power != vec3(0)) power /= volume_of(i);
    square += store_b(push.side, i, lit(power));
  }
  store_norm(push.side, square);
}
