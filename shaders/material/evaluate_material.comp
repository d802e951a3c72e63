#version 460
#extension GL_GOOGLE_include_directive : require
#include "material/material.h"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { EvaluateMaterialPush push; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  vec3 position = push.material.pattern == PATTERN_NONE ? vec3(0) : load_vec3(push.nodes, i);
  float depth = push.material.pattern == PATTERN_LAYERS ? load_float(push.depth, i) : 0.0;
  push.optical.at[i] = material_at(push.material, position, depth);
}
