#version 460
#extension GL_GOOGLE_include_directive : require
#include "surface/even_face.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// The mean, over the open faces around every surface vertex, of the exitance that is made even.
struct EvenVerticesPush {
  EvenRef even;
  Uints face_offset;
  Uints face_incidence;
  Vec3s mean;  // W/mm^2, written
  uint count;
};
layout(push_constant, scalar) uniform Block { EvenVerticesPush push; };

void main() {
  uint v = gl_GlobalInvocationID.x;
  if (v >= push.count) return;
  vec3 sum = vec3(0), weight = vec3(0);
  for (uint k = push.face_offset.at[v]; k < push.face_offset.at[v + 1u]; ++k) {
    EvenFace face = even_face(push.even, push.face_incidence.at[k]);
    sum += face.area * face.share * face.far;
    weight += face.area * face.share;
  }
  push.mean.at[v] = mix(vec3(0), sum / weight, greaterThan(weight, vec3(0)));
}
