#version 460
#extension GL_GOOGLE_include_directive : require
#define MOMENTS 1
#include "solver/right_hand_side.glsl"

// b at every vertex from a load that is given, scaled, and its norm.
struct RightHandSideGivenPush {
  Vec3s load;
  RightHandSideRef side;
  uint count;
};
layout(push_constant, scalar) uniform Block { RightHandSideGivenPush push; };

void main() {
  vec3 square = vec3(0);
  EACH(i, push.count) { square += store_b(push.side, i, lit(push.load.at[i])); }
  store_norm(push.side, square);
}
