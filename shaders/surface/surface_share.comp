#version 460
#extension GL_GOOGLE_include_directive : require
#include "surface/surface_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// fem: the first `count` vertices, each with a third of its open faces; graph methods: the surface
// nodes.
struct SurfaceSharePush {
  Vec3s vertices;
  Uvec3s faces;
  Uints face_kinds;
  Uints face_offset;
  Uints face_incidence;
  Vec3s q;
  Scales scale;
  SurfaceShares share;
  uint count;
  uint fem;
  float reflected;  // of q
};
layout(push_constant, scalar) uniform Block { SurfaceSharePush push; };

#include "shared/face_area.glsl"

// Share of a whole face, `reflected` times its area.
SurfaceShare of_face(uint face) {
  vec3 q = push.q.at[face];
  float area = area_of(push.faces, push.vertices, face);
  float unlit = q.x + q.y + q.z < push.scale.at[0].unlit ? area : 0.0;
  return SurfaceShare(vec3(area, unlit, 0), area * push.reflected * q);
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  SurfaceShare sum = SurfaceShare(vec3(0), vec3(0));
  if (push.fem == 1u) {
    for (uint k = push.face_offset.at[i]; k < push.face_offset.at[i + 1u]; ++k) {
      SurfaceShare face = of_face(push.face_incidence.at[k]);
      sum.area += face.area / 3.0;
      sum.reflected += face.reflected / 3.0;
    }
  } else if (push.face_kinds.at[i] == FACE_OPEN) {
    sum = of_face(i);
  }
  if (sum.area.x > 0.0) sum.reflected /= sum.area.x;
  push.share.at[i] = sum;
}
