#version 460
#extension GL_GOOGLE_include_directive : require
#include "deform/deform_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// The triangles around vertex v are incidence[k], k from offset[v] to offset[v + 1].
struct DeformNormalsPush {
  Vec3s rest;   // vertices, mm
  Vec3s moved;  // the same
  Vec3s rest_normals;
  Vec3s normals;  // written
  Uvec3s triangles;
  Uints offset;
  Uints incidence;
  uint count;
};
layout(push_constant, scalar) uniform Block { DeformNormalsPush push; };

// A triangle as a frame: two edges and its doubled normal.
mat3 frame_of(Vec3s vertices, uvec3 ids) {
  vec3 p = vertices.at[ids.x];
  vec3 u = vertices.at[ids.y] - p, v = vertices.at[ids.z] - p;
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
  vec3 normal = push.rest_normals.at[v], sum = vec3(0);
  uint end = push.offset.at[v + 1u];
  for (uint k = push.offset.at[v]; k < end; ++k) {
    sum += carried(push.triangles.at[push.incidence.at[k]], normal);
  }
  float size = length(sum);
  push.normals.at[v] = size > 0.0 ? sum / size : normal;
}
