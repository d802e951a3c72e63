#version 460
#extension GL_GOOGLE_include_directive : require
#include "deform/deform_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { DeformNormalsPush push; };

// A triangle as a frame: two edges and its doubled normal.
mat3 frame_of(Vec3s vertices, uvec3 ids) {
  vec3 p = load_vec3(vertices, ids.x);
  vec3 u = load_vec3(vertices, ids.y) - p, v = load_vec3(vertices, ids.z) - p;
  return mat3(u, v, cross(u, v));
}

// What the triangle makes of `normal`: the cofactors of the map that takes one frame to the other and the unit normal
// to the unit normal, so that a rotation is that rotation; times twice the area it had.
vec3 carried(uvec3 ids, vec3 normal) {
  mat3 rest = frame_of(push.rest, ids), moved = frame_of(push.moved, ids);
  float area = length(rest[2]), now = length(moved[2]);
  if (area == 0.0 || now == 0.0) return vec3(0);
  vec3 n = rest[2] / area, m = moved[2] / now;
  // Coordinates of `normal` against the gradients of the frame at rest, put on those of the moved frame: J^-T normal.
  float along_u = dot(normal, rest[0]), along_v = dot(normal, rest[1]), along_n = dot(normal, n);
  vec3 tangent = (along_u * cross(moved[1], m) + along_v * cross(m, moved[0])) / now;
  return now * (tangent + along_n * m);
}

void main() {
  uint v = gl_GlobalInvocationID.x;
  if (v >= push.count) return;
  vec3 normal = load_vec3(push.rest_normals, v), sum = vec3(0);
  uint end = load_uint(push.offset, v + 1u);
  for (uint k = load_uint(push.offset, v); k < end; ++k) {
    sum += carried(load_uvec3(push.triangles, load_uint(push.incidence, k)), normal);
  }
  float size = length(sum);
  push.normals.at[v] = size > 0.0 ? sum / size : normal;
}
