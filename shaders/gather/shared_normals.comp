#version 460
#extension GL_GOOGLE_include_directive : require
#include "gather/gather_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// Unit normals of surfaces that bodies share, at their vertices: means over the triangles around them, weighed as in
// smooth_normals.comp.
struct SharedNormalsPush {
  Vec3s vertices;
  Uints vertex;  // of a shared surface
  Uints offset;  // of these, into rim
  Uvec2s rim;    // the other corners of the triangles around
  Vec3s normals;  // per vertex of the level, written
  uint count;
};
layout(push_constant, scalar) uniform Block { SharedNormalsPush push; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  uint v = push.vertex.at[i];
  vec3 p = push.vertices.at[v], sum = vec3(0);
  for (uint k = push.offset.at[i]; k < push.offset.at[i + 1u]; ++k) {
    uvec2 rim = push.rim.at[k];
    vec3 a = push.vertices.at[rim.x] - p, b = push.vertices.at[rim.y] - p;
    sum += cross(a, b) / max(dot(a, a) * dot(b, b), 1e-30);
  }
  push.normals.at[v] = sum / max(length(sum), 1e-30);
}
