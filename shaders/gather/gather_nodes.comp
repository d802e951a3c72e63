#version 460
#extension GL_GOOGLE_include_directive : require
#include "gather/gather_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// Nodes `first` to `first` + `count` - 1 of the tree, leaves before their parents; and, behind all
// nodes, every face by its place in TreeRef::order.
struct GatherNodesPush {
  SolidRefs solid;  // one
  Vec3s gathered;   // W/mm^2 per face
  Vec3s exitance;   // W/mm^2 per surface vertex
  GatherNodes nodes;
  uint first;
  uint count;
};
layout(push_constant, scalar) uniform Block { GatherNodesPush push; };

SolidRef solid;

GatherNode node_of_face(uint face) {
  GatherNode node = GatherNode(vec3(0), vec3(0), vec3(0), vec3(0), 0.0);
  if (!is_open(solid.body.face_kinds, face)) return node;
  uvec3 ids = solid.body.faces.at[face];
  vec3 a = solid.body.vertices.at[ids.x], b = solid.body.vertices.at[ids.y],
       c = solid.body.vertices.at[ids.z];
  node.normal = 0.5 * cross(b - a, c - a);
  node.area = length(node.normal);
  node.place = node.area * (a + b + c) / 3.0;
  node.gathered = node.area * push.gathered.at[face];
  for (int k = 0; k < 3; ++k) node.exitance += node.area / 3.0 * push.exitance.at[ids[k]];
  return node;
}

GatherNode sum_of(GatherNode a, GatherNode b) {
  return GatherNode(a.exitance + b.exitance, a.gathered + b.gathered, a.normal + b.normal, a.place + b.place,
                    a.area + b.area);
}

GatherNode node_of_leaf(uint leaf) {
  GatherNode sum = GatherNode(vec3(0), vec3(0), vec3(0), vec3(0), 0.0);
  for (uint k = solid.tree.leaf_begin.at[leaf]; k < solid.tree.leaf_begin.at[leaf + 1u]; ++k) {
    GatherNode face = node_of_face(solid.tree.order.at[k]);
    push.nodes.at[2u * solid.tree.leaf_count + k] = face;
    sum = sum_of(sum, face);
  }
  return sum;
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  solid = push.solid.at[0];
  uint node = push.first + i, leaves = solid.tree.leaf_count;
  if (node >= leaves) {
    push.nodes.at[node] = node_of_leaf(node - leaves);
  } else {
    push.nodes.at[node] = sum_of(push.nodes.at[2u * node], push.nodes.at[2u * node + 1u]);
  }
}
