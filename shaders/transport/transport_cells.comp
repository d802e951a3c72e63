#version 460
#extension GL_GOOGLE_include_directive : require
#include "transport/transport_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// The tets in their present shape as rays see them, but for the light.
struct TransportCellsPush {
  Vec3s vertices;
  Uvec4s tets;
  Uints crossings;  // four per tet
  TransportCells cells;
  uint count;
};
layout(push_constant, scalar) uniform Block { TransportCellsPush push; };

void main() {
  uint tet = gl_GlobalInvocationID.x;
  if (tet >= push.count) return;
  uvec4 ids = push.tets.at[tet];
  vec3 p = push.vertices.at[ids.w];
  vec3 a = push.vertices.at[ids.x] - p, b = push.vertices.at[ids.y] - p, c = push.vertices.at[ids.z] - p;
  vec3 n_0 = cross(b, c), n_1 = cross(c, a), n_2 = cross(a, b);
  float six_volume = dot(a, n_0);
  // Files have their tets turned so that this is negative.
  float inverse = six_volume < 0.0 ? 1.0 / six_volume : 0.0;
  vec3 g_0 = inverse * n_0, g_1 = inverse * n_1, g_2 = inverse * n_2, g_3 = -(g_0 + g_1 + g_2);
  push.cells.at[tet].at_x = vec4(g_0.x, g_1.x, g_2.x, g_3.x);
  push.cells.at[tet].at_y = vec4(g_0.y, g_1.y, g_2.y, g_3.y);
  push.cells.at[tet].at_z = vec4(g_0.z, g_1.z, g_2.z, g_3.z);
  vec3 at_p = -vec3(dot(g_0, p), dot(g_1, p), dot(g_2, p));
  push.cells.at[tet].at_0 = vec4(at_p, 1.0 - at_p.x - at_p.y - at_p.z);
  push.cells.at[tet].crossings = uvec4(push.crossings.at[4u * tet], push.crossings.at[4u * tet + 1u],
                                       push.crossings.at[4u * tet + 2u], push.crossings.at[4u * tet + 3u]);
}
