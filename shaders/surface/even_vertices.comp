#version 460
#extension GL_GOOGLE_include_directive : require
#include "surface/even_face.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// The mean of the exitance that is made even over the unlit open faces around every surface vertex, and over the lit
// ones: none is carried across the edge of a shadow.
struct EvenVerticesPush {
  EvenRef even;
  Uints face_offset;
  Uints face_incidence;
  Vec3s mean;  // W/mm^2, two per vertex, written
  uint count;
};
layout(push_constant, scalar) uniform Block { EvenVerticesPush push; };

void main() {
  uint v = gl_GlobalInvocationID.x;
  if (v >= push.count) return;
  vec3 sum[2], weight[2];
  for (uint lit = 0u; lit < 2u; ++lit) {
    sum[lit] = vec3(0);
    weight[lit] = vec3(0);
  }
  for (uint k = push.face_offset.at[v]; k < push.face_offset.at[v + 1u]; ++k) {
    EvenFace face = even_face(push.even, push.face_incidence.at[k]);
    sum[face.lit] += face.area * face.share * face.far;
    weight[face.lit] += face.area * face.share;
  }
  for (uint lit = 0u; lit < 2u; ++lit) {
    push.mean.at[2u * v + lit] = mix(vec3(0), sum[lit] / weight[lit], greaterThan(weight[lit], vec3(0)));
  }
}
