#version 460
#extension GL_GOOGLE_include_directive : require
#include "material/material.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// optical[i] = material_at(nodes[i], depth[i]).
struct EvaluateMaterialPush {
  Material material;
  Vec3s nodes;   // mm; not read for a homogeneous material
  Floats depth;  // mm below the surface, of the nodes; read for layers
  Opticals optical;
  uint count;
};
layout(push_constant, scalar) uniform Block { EvaluateMaterialPush push; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  vec3 position = push.material.pattern == PATTERN_NONE ? vec3(0) : push.nodes.at[i];
  float depth = push.material.pattern == PATTERN_LAYERS ? push.depth.at[i] : 0.0;
  push.optical.at[i] = material_at(push.material, position, depth);
}
