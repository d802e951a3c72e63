#version 460
#extension GL_GOOGLE_include_directive : require
#include "gather/gather_shared.h"
#include "shared/creases.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// Normals of the smooth surface at the corners of open faces: means over the faces around a vertex, as far as no crease
// parts them from the face.
struct SmoothNormalsPush {
  BodyRefs body;      // one
  Uints face_offset;  // open faces around each surface vertex
  Uints face_incidence;
  Vec3s normals;      // three per face, unit, written
};
layout(push_constant, scalar) uniform Block { SmoothNormalsPush push; };

BodyRef body;

// Along the normal of face `face` at its vertex v; of the length that makes a sum over the faces of a ball's mesh point
// as the ball does (Max 1999).
vec3 weighed_normal(uint face, uint v) {
  uvec3 ids = body.faces.at[face];
  uint next = v == ids.x ? ids.y : v == ids.y ? ids.z : ids.x, last = ids.x + ids.y + ids.z - v - next;
  vec3 a = body.vertices.at[next] - body.vertices.at[v], b = body.vertices.at[last] - body.vertices.at[v];
  return cross(a, b) / max(dot(a, a) * dot(b, b), 1e-30);
}

vec3 unit(vec3 v) {
  return v / max(length(v), 1e-30);
}

void main() {
  uint i = gl_GlobalInvocationID.x, face = i / 3u;
  body = push.body.at[0];
  if (face >= body.face_count) return;
  uvec3 ids = body.faces.at[face];
  uint v = ids[i % 3u];
  vec3 own = unit(weighed_normal(face, v)), sum = vec3(0);
  if (is_open(body.face_kinds, face)) {
    for (uint k = push.face_offset.at[v]; k < push.face_offset.at[v + 1u]; ++k) {
      vec3 normal = weighed_normal(push.face_incidence.at[k], v);
      sum += smooth_share(dot(own, unit(normal))) * normal;
    }
  }
  push.normals.at[i] = sum == vec3(0) ? own : unit(sum);
}
