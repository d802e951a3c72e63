#version 460
#extension GL_GOOGLE_include_directive : require
#include "deform/deform_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// A node keeps its barycentric coordinates in its tet.
struct DeformNodesPush {
  Vec3s vertices;  // mm
  Uvec4s tets;
  Uints face_tets;
  Vec4s place;  // per node
  Vec3s nodes;  // mm, written
  uint tet_count;
  uint count;
};
layout(push_constant, scalar) uniform Block { DeformNodesPush push; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  uvec4 tet = push.tets.at[i < push.tet_count ? i : push.face_tets.at[i - push.tet_count]];
  vec4 place = push.place.at[i];
  vec3 p = vec3(0);
  for (int k = 0; k < 4; ++k) p += place[k] * push.vertices.at[tet[k]];
  push.nodes.at[i] = p;
}
