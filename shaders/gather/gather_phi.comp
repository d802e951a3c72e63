#version 460
#extension GL_GOOGLE_include_directive : require
#include "gather/gather_shared.h"
#include "solver/fields.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { GatherPhiPush push; };

void main() {
  uint v = gl_GlobalInvocationID.x;
  if (v >= push.count) return;
  push.points.at[v].phi = load_vec3_or_one(push.to_phi, v) * load_field(push.x, v).phi * load_scale(push.scale).scale;
}
