#version 460
#extension GL_GOOGLE_include_directive : require
#include "gather/gather_shared.h"
#include "solver/fields.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// Phi of the points from a solution at the vertices.
struct GatherPhiPush {
  Fields x;
  Vec3s to_phi;  // null: 1
  Scales scale;
  GatherPoints points;
  uint count;
};
layout(push_constant, scalar) uniform Block { GatherPhiPush push; };

void main() {
  uint v = gl_GlobalInvocationID.x;
  if (v >= push.count) return;
  push.points.at[v].phi = vec4(element_or_one(push.to_phi, v) * push.x.at[v].phi * push.scale.at[0].scale, 0.0);
}
