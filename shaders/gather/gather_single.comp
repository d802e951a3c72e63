#version 460
#extension GL_GOOGLE_include_directive : require
#include "gather/gather_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// Scale at surface vertices that adds what is gathered, as it is, to the exitance.
struct GatherSinglePush {
  Vec3s exitance;  // W/mm^2 per surface vertex
  GatherScales scale;
  uint count;
};
layout(push_constant, scalar) uniform Block { GatherSinglePush push; };

void main() {
  uint v = gl_GlobalInvocationID.x;
  if (v < push.count) push.scale.at[v] = GatherScale(vec3(1), push.exitance.at[v], vec3(0));
}
