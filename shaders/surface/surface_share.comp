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
  Boundaries boundaries;  // by body
  Uints face_offset;
  Uints face_incidence;
  Vec3s q;
  Scales scale;
  SurfaceShares share;
  uint count;
  uint fem;
};
layout(push_constant, scalar) uniform Block { SurfaceSharePush push; };

#include "shared/face_area.glsl"

// Share of a whole face, what is reflected times its area.
SurfaceShare of_face(uint face) {
  vec3 q = push.q.at[face];
  float area = area_of(push.faces, push.vertices, face);
  float unlit = q.x + q.y + q.z < push.scale.at[0].unlit ? area : 0.0;
  uint body = body_behind(push.face_kinds, face);
  return SurfaceShare(vec3(area, unlit, 0), area * push.boundaries.at[body].reflected * q, body);
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  SurfaceShare sum = SurfaceShare(vec3(0), vec3(0), 0u);
  if (push.fem == 1u) {
    for (uint k = push.face_offset.at[i]; k < push.face_offset.at[i + 1u]; ++k) {
      SurfaceShare face = of_face(push.face_incidence.at[k]);
      sum.area += face.area / 3.0;
      sum.reflected += face.reflected / 3.0;
      sum.body = face.body;
    }
  } else if (is_open(push.face_kinds, i)) {
    sum = of_face(i);
  }
  if (sum.area.x > 0.0) sum.reflected /= sum.area.x;
  push.share.at[i] = sum;
}
