#version 460
#extension GL_GOOGLE_include_directive : require
#include "gather/gather_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { GatherNodesPush push; };

SolidRef solid;

GatherNode node_of_face(uint face) {
  GatherNode node = GatherNode(vec3(0), vec3(0), vec3(0), vec3(0), 0.0);
  if (load_uint(solid.body.face_kinds, face) != FACE_OPEN) return node;
  uvec3 ids = load_uvec3(solid.body.faces, face);
  vec3 a = load_vec3(solid.body.vertices, ids.x), b = load_vec3(solid.body.vertices, ids.y),
       c = load_vec3(solid.body.vertices, ids.z);
  node.normal = 0.5 * cross(b - a, c - a);
  node.area = length(node.normal);
  node.place = node.area * (a + b + c) / 3.0;
  node.gathered = node.area * load_vec3(push.gathered, face);
  for (int k = 0; k < 3; ++k) node.exitance += node.area / 3.0 * load_vec3(push.exitance, ids[k]);
  return node;
}

GatherNode sum_of(GatherNode a, GatherNode b) {
  return GatherNode(a.exitance + b.exitance, a.gathered + b.gathered, a.normal + b.normal, a.place + b.place,
                    a.area + b.area);
}

GatherNode node_of_leaf(uint leaf) {
  GatherNode sum = GatherNode(vec3(0), vec3(0), vec3(0), vec3(0), 0.0);
  for (uint k = load_uint(solid.tree.leaf_begin, leaf); k < load_uint(solid.tree.leaf_begin, leaf + 1u); ++k) {
    GatherNode face = node_of_face(load_uint(solid.tree.order, k));
    push.nodes.at[2u * solid.tree.leaf_count + k] = face;
    sum = sum_of(sum, face);
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
