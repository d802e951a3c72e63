#version 460
#extension GL_GOOGLE_include_directive : require
#include "exchange/exchange_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { ExchangeBoxesPush push; };

Box around_faces(uint leaf) {
  Box box = Box(vec3(1e37), vec3(-1e37));
  for (uint k = load_uint(push.leaf_begin, leaf); k < load_uint(push.leaf_begin, leaf + 1u); ++k) {
    uvec3 ids = load_uvec3(push.faces, load_uint(push.order, k));
    vec3 a = load_vec3(push.vertices, ids.x), b = load_vec3(push.vertices, ids.y), c = load_vec3(push.vertices, ids.z);
    box = Box(min(box.low, min(a, min(b, c))), max(box.high, max(a, max(b, c))));
  }
  return box;
}

Box around_children(uint node) {
  Box a = load_box(push.boxes, 2u * node), b = load_box(push.boxes, 2u * node + 1u);
  return Box(min(a.low, b.low), max(a.high, b.high));
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  uint node = push.first + i;
  push.boxes.at[node] = node >= push.leaf_count ? around_faces(node - push.leaf_count) : around_children(node);
}
