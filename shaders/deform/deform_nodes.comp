#version 460
#extension GL_GOOGLE_include_directive : require
#include "deform/deform_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { DeformNodesPush push; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  uvec4 tet = load_uvec4(push.tets, i < push.tet_count ? i : load_uint(push.face_tets, i - push.tet_count));
  vec4 place = load_vec4(push.place, i);
  vec3 p = vec3(0);
  for (int k = 0; k < 4; ++k) p += place[k] * load_vec3(push.vertices, tet[k]);
  push.nodes.at[i] = p;
}
