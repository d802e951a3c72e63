#version 460
#extension GL_GOOGLE_include_directive : require
#include "light/render_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// What the body hides of every environment on a level from the next coarser one.
struct EnvironmentFinerPush {
  Uints index;
  Floats weight;
  Vec3s coarse;
  Vec3s hidden;  // written
  uint width;
  uint face_count;
  uint coarse_count;
  uint environments;
};
layout(push_constant, scalar) uniform Block { EnvironmentFinerPush push; };

void main() {
  uint f = gl_GlobalInvocationID.x;
  if (f >= push.face_count) return;
  for (uint environment = 0u; environment < push.environments; ++environment) {
    uint coarse = environment * push.coarse_count;
    vec3 sum = vec3(0);
    for (uint k = f * push.width; k < (f + 1u) * push.width; ++k) {
      sum += push.weight.at[k] * push.coarse.at[coarse + push.index.at[k]];
    }
    push.hidden.at[environment * push.face_count + f] = sum;
  }
}
