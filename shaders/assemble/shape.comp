#version 460
#extension GL_GOOGLE_include_directive : require
#include "assemble/assembly_shared.h"
#include "solver/tet_volume.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// Measures every tet and outside face.
struct ShapePush {
  Vec3s vertices;
  Uvec4s tets;
  Uvec3s faces;
  Floats etendue;  // as of BodyRef
  Floats tet_shape;
  Floats face_area;  // mm^2
  uint tet_count;
  uint face_count;
  LeastTet least;
};
layout(push_constant, scalar) uniform Block { ShapePush push; };

void measure_tet(uint t) {
  uvec4 tet = push.tets.at[t];
  vec3 p = push.vertices.at[tet.x];
  vec3 e1 = push.vertices.at[tet.y] - p, e2 = push.vertices.at[tet.z] - p;
  vec3 e3 = push.vertices.at[tet.w] - p;
  // The gradient of corner k is n_k / (6 V), up to an orientation that cancels in products.
  vec3 n1 = cross(e2, e3), n2 = cross(e3, e1), n3 = cross(e1, e2);
  vec3 n0 = -(n1 + n2 + n3);
  float squares = dot(n0, n0) + dot(n1, n1) + dot(n2, n2) + dot(n3, n3);
  float six_volume = bounded_six_volume(dot(e1, n1), squares, push.least);
  float etendue = number_or_one(push.etendue, t), factor = etendue / (6.0 * six_volume);
  uint at = TET_SHAPE * t;
  push.tet_shape.at[at] = factor * dot(n0, n1);
  push.tet_shape.at[at + 1u] = factor * dot(n0, n2);
  push.tet_shape.at[at + 2u] = factor * dot(n0, n3);
  push.tet_shape.at[at + 3u] = factor * dot(n1, n2);
  push.tet_shape.at[at + 4u] = factor * dot(n1, n3);
  push.tet_shape.at[at + 5u] = factor * dot(n2, n3);
  push.tet_shape.at[at + 6u] = etendue * six_volume / 6.0;
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i < push.tet_count) measure_tet(i);
  if (i >= push.face_count) return;
  uvec3 face = push.faces.at[i];
  vec3 p = push.vertices.at[face.x];
  vec3 doubled = cross(push.vertices.at[face.y] - p, push.vertices.at[face.z] - p);
  push.face_area.at[i] = 0.5 * length(doubled);
}
