#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/body_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// The tets in their present shape as rays see them, but for their crossings, which are there.
struct TetCellsPush {
  Vec3s vertices;
  Uvec4s tets;
  TetCells cells;
  uint count;
  uint inverted;  // 1: some may be turned inside out, and rays are to end there
};
layout(push_constant, scalar) uniform Block { TetCellsPush push; };

// Six volumes of a tet that counts as thinner, mm^3: rays pass it as one of no thickness.
const float FLAT = 1e-24;

void main() {
  uint tet = gl_GlobalInvocationID.x;
  if (tet >= push.count) return;
  uvec4 ids = push.tets.at[tet];
  vec3 p = push.vertices.at[ids.w];
  vec3 a = push.vertices.at[ids.x] - p, b = push.vertices.at[ids.y] - p, c = push.vertices.at[ids.z] - p;
  vec3 n_0 = cross(b, c), n_1 = cross(c, a), n_2 = cross(a, b);
  float six_volume = dot(a, n_0);
  float inverse = 1.0 / (abs(six_volume) < FLAT ? -FLAT : six_volume);
  // Files have their tets turned so that the volume is negative.
  if (push.inverted == 1u && six_volume > 0.0) inverse = 0.0;
  vec3 g_0 = inverse * n_0, g_1 = inverse * n_1, g_2 = inverse * n_2, g_3 = -(g_0 + g_1 + g_2);
  push.cells.at[tet].along_x = vec4(g_0.x, g_1.x, g_2.x, g_3.x);
  push.cells.at[tet].along_y = vec4(g_0.y, g_1.y, g_2.y, g_3.y);
  push.cells.at[tet].along_z = vec4(g_0.z, g_1.z, g_2.z, g_3.z);
}
