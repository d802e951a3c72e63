#version 460
#extension GL_GOOGLE_include_directive : require
#include "assemble/assembly_shared.h"
#include "solver/tet_volume.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { GridMaterialPush push; };

float volume(uint tet) {
  uvec4 corners = load_uvec4(push.tets, tet);
  vec3 p = load_vec3(push.vertices, corners.x);
  return tet_volume(load_vec3(push.vertices, corners.y) - p, load_vec3(push.vertices, corners.z) - p,
                    load_vec3(push.vertices, corners.w) - p, push.least);
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  float sum = 0.0;
  Optical optical = Optical(vec3(0), vec3(0));
  uint end = load_assembly_uint(push.tet_offset, i + 1u);
  for (uint k = load_assembly_uint(push.tet_offset, i); k < end; ++k) {
    uint tet = load_assembly_uint(push.tet_incidence, k);
    float size = volume(tet);
    Optical own = load_optical(push.optical, push.even == 1u ? 0u : tet);
    optical.sigma_s_prime += size * own.sigma_s_prime;
    optical.sigma_a += size * own.sigma_a;
    sum += size;
  }
  push.vertex_optical.at[i] = Optical(optical.sigma_s_prime / sum, optical.sigma_a / sum);
  push.volume.at[i] = sum / 4.0;
}
