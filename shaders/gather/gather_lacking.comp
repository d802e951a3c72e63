#version 460
#extension GL_GOOGLE_include_directive : require
#include "gather/gather_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// Adds to phi of the points the fluence whose scattering gather_first.comp found to be lacking.
struct GatherLackingPush {
  Uvec4s tets;
  Uints tet_offset;  // tets around each vertex
  Uints tet_incidence;
  Vec3s lacking;  // W, at the corners of the tets, four each
  Vec3s mass;     // of transport_mass.comp
  GatherPoints points;
  uint count;
};
layout(push_constant, scalar) uniform Block { GatherLackingPush push; };

void main() {
  uint v = gl_GlobalInvocationID.x;
  if (v >= push.count) return;
  vec3 sum = vec3(0);
  for (uint k = push.tet_offset.at[v]; k < push.tet_offset.at[v + 1u]; ++k) {
    uint tet = push.tet_incidence.at[k];
    uvec4 corners = push.tets.at[tet];
    uint own = corners.x == v ? 0u : corners.y == v ? 1u : corners.z == v ? 2u : 3u;
    sum += push.lacking.at[4u * tet + own];
  }
  vec3 mass = push.mass.at[v];
  push.points.at[v].phi += vec4(mix(sum / mass, vec3(0), equal(mass, vec3(0))), 0.0);
}
