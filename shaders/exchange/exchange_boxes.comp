#version 460
#extension GL_GOOGLE_include_directive : require
#include "exchange/exchange_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// Boxes of the nodes `first` to `first` + `count` - 1 of the tree, leaves before their parents.
struct ExchangeBoxesPush {
  Vec3s vertices;
  Uvec3s faces;
  Uints order;
  Uints leaf_begin;
  Boxes boxes;  // by node
  uint first;
  uint count;
  uint leaf_count;
};
layout(push_constant, scalar) uniform Block { ExchangeBoxesPush push; };

Box around_faces(uint leaf) {
  Box box = Box(vec3(1e37), vec3(-1e37));
  for (uint k = push.leaf_begin.at[leaf]; k < push.leaf_begin.at[leaf + 1u]; ++k) {
    uvec3 ids = push.faces.at[push.order.at[k]];
    vec3 a = push.vertices.at[ids.x], b = push.vertices.at[ids.y], c = push.vertices.at[ids.z];
    box = Box(min(box.low, min(a, min(b, c))), max(box.high, max(a, max(b, c))));
  }
  return box;
}

Box around_children(uint node) {
  Box a = push.boxes.at[2u * node], b = push.boxes.at[2u * node + 1u];
  return Box(min(a.low, b.low), max(a.high, b.high));
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  uint node = push.first + i;
  push.boxes.at[node] = node >= push.leaf_count ? around_faces(node - push.leaf_count) : around_children(node);
}
