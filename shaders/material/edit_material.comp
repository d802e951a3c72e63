#version 460
#extension GL_GOOGLE_include_directive : require
#include "material/edits.h"
#include "material/edits.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { EditMaterialPush push; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  vec3 position = push.edit_count > 0u ? load_vec3(push.nodes, i) : vec3(0);
  float depth = push.with_depth == 1u ? load_float(push.depth, i) : 0.0;
  AllEdits edits = AllEdits(push.edits, push.points, push.texels, push.edit_count, push.spacing);
  push.optical.at[i] = edited_at(edits, push.base.at[i], position, depth);
}
