#version 460
#extension GL_GOOGLE_include_directive : require
#include "assemble/assembly_shared.h"
#include "solver/tet_volume.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// The mean coefficients of the tets around each vertex, by volume, and a fourth of that, mm^3.
struct GridMaterialPush {
  Vec3s vertices;
  Uvec4s tets;
  Opticals optical;  // of the tets
  Uints tet_offset;
  Uints tet_incidence;
  Opticals vertex_optical;
  Floats volume;
  uint count;  // vertices
  uint even;   // 1: the coefficients are the same everywhere
  LeastTet least;
};
layout(push_constant, scalar) uniform Block { GridMaterialPush push; };

float volume(uint tet) {
  uvec4 corners = push.tets.at[tet];
  vec3 p = push.vertices.at[corners.x];
  return tet_volume(push.vertices.at[corners.y] - p, push.vertices.at[corners.z] - p,
                    push.vertices.at[corners.w] - p, push.least);
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  float sum = 0.0;
  Optical optical = Optical(vec3(0), vec3(0));
  uint end = push.tet_offset.at[i + 1u];
  for (uint k = push.tet_offset.at[i]; k < end; ++k) {
    uint tet = push.tet_incidence.at[k];
    float size = volume(tet);
    Optical own = push.optical.at[push.even == 1u ? 0u : tet];
    optical.sigma_s_prime += size * own.sigma_s_prime;
    optical.sigma_a += size * own.sigma_a;
    sum += size;
  }
  push.vertex_optical.at[i] = Optical(optical.sigma_s_prime / sum, optical.sigma_a / sum);
  push.volume.at[i] = sum / 4.0;
}
