#version 460
#extension GL_GOOGLE_include_directive : require
#include "gather_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { GatherNodesPush push; };

SolidRef solid;
#include "gather_nodes.glsl"

GatherNode node_of_leaf(uint leaf) {
  GatherNode sum = GatherNode(vec3(0), vec3(0), vec3(0), vec3(0), 0.0);
  for (uint k = load_uint(solid.tree.leaf_begin, leaf); k < load_uint(solid.tree.leaf_begin, leaf + 1u); ++k) {
    sum = sum_of(sum, node_of_face(load_uint(solid.tree.order, k)));
  }
  return sum;
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  solid = load_solid(push.solid);
  uint node = push.first + i, leaves = solid.tree.leaf_count;
  if (node >= leaves) {
    push.nodes.at[node] = node_of_leaf(node - leaves);
  } else {
    push.nodes.at[node] = sum_of(load_gather_node(push.nodes, 2u * node), load_gather_node(push.nodes, 2u * node + 1u));
  }
}
