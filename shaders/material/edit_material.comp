#version 460
#extension GL_GOOGLE_include_directive : require
#include "material/edits.h"
#include "material/edits.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// optical[i] = base[i] after all edits, one after the other.
struct EditMaterialPush {
  Opticals base;  // may be `optical`
  Opticals optical;
  Vec3s nodes;   // mm, at rest; not read without edits
  Floats depth;  // mm, of the nodes
  MaterialEdits edits;
  Vec3s points;  // mm, of all strokes
  Vec3s texels;  // of all images
  float spacing;         // mm from node to node: what is finer in an image is taken together
  uint edit_count;
  uint with_depth;  // 0: depth is not read
  uint count;
};
layout(push_constant, scalar) uniform Block { EditMaterialPush push; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  vec3 position = push.edit_count > 0u ? push.nodes.at[i] : vec3(0);
  float depth = push.with_depth == 1u ? push.depth.at[i] : 0.0;
  AllEdits edits = AllEdits(push.edits, push.points, push.texels, push.edit_count, push.spacing);
  push.optical.at[i] = edited_at(edits, push.base.at[i], position, depth);
}
