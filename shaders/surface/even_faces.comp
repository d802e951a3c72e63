#version 460
#extension GL_GOOGLE_include_directive : require
#include "surface/even_face.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// Makes the exitance of open faces even, by the means at their vertices. What all of them lose and gain is the same.
struct EvenFacesPush {
  EvenRef even;
  Uints face_kinds;
  Vec3s mean;  // W/mm^2, two per surface vertex
  uint count;
};
layout(push_constant, scalar) uniform Block { EvenFacesPush push; };

void main() {
  uint f = gl_GlobalInvocationID.x;
  if (f >= push.count || push.face_kinds.at[f] != FACE_OPEN) return;
  uvec3 ids = push.even.faces.at[f];
  EvenFace face = even_face(push.even, f);
  vec3 mean = vec3(0);
  for (uint k = 0u; k < 3u; ++k) mean += push.mean.at[2u * ids[k] + face.lit] / 3.0;
  push.even.exitance.at[f] += face.share * (mean - face.far);
}
