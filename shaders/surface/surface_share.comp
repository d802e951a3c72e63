#version 460
#extension GL_GOOGLE_include_directive : require
#include "surface/surface_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { SurfaceSharePush push; };

#include "shared/face_area.glsl"

// Of a whole face, `reflected` times its area.
SurfaceShare of_face(uint face) {
  vec3 q = load_vec3(push.q, face);
  float area = area_of(push.faces, push.vertices, face);
  float unlit = q.x + q.y + q.z < load_scale(push.scale).unlit ? area : 0.0;
  return SurfaceShare(vec2(area, unlit), area * push.reflected * q);
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  SurfaceShare sum = SurfaceShare(vec2(0), vec3(0));
  if (push.fem == 1u) {
    for (uint k = load_uint(push.face_offset, i); k < load_uint(push.face_offset, i + 1u); ++k) {
      SurfaceShare face = of_face(load_uint(push.face_incidence, k));
      sum.area += face.area / 3.0;
      sum.reflected += face.reflected / 3.0;
    }
  } else if (load_uint(push.face_kinds, i) == FACE_OPEN) {
    sum = of_face(i);
  }
  if (sum.area.x > 0.0) sum.reflected /= sum.area.x;
  push.share.at[i] = sum;
}
