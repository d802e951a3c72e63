#version 460
#extension GL_GOOGLE_include_directive : require
#include "assemble/assembly_shared.h"
#include "solver/fields.glsl"
#include "material/optics.h"
#include "solver/stored_rows.glsl"
#include "shared/stride.glsl"
#include "shared/reduce.glsl"

// Scaled b at every vertex, and its norm.
struct RightHandSideFemPush {
  Vec3s vertices;
  Uvec3s faces;
  Uints face_offset;
  Uints face_incidence;
  Vec3s q;
  Scales scale;
  Entries diagonal;
  Fields b;
  SolveStates state;
  Reduction reduction;
  uint count;
  uint surface_count;
  Boundary boundary;
};
layout(push_constant, scalar) uniform Block { RightHandSideFemPush push; };

// Integral of q against the basis function of surface vertex i: a third of each of its open faces.
vec3 surface_load(uint i) {
  vec3 sum = vec3(0), inverse = push.scale.at[0].inverse;
  for (uint k = push.face_offset.at[i]; k < push.face_offset.at[i + 1u]; ++k) {
    uint face = push.face_incidence.at[k];
    uvec3 corners = push.faces.at[face];
    vec3 p = push.vertices.at[corners.x];
    float area = 0.5 * length(cross(push.vertices.at[corners.y] - p, push.vertices.at[corners.z] - p));
    sum += push.q.at[face] * inverse * area;
  }
  return sum / 3.0;
}

void main() {
  vec3 square = vec3(0);
  EACH(i, push.count) {
    Field b = diffuse_source(push.boundary, i < push.surface_count ? surface_load(i) : vec3(0));
    push.b.at[i] = b;
    square += product(b, solved(load_diagonal(push.diagonal, i), b));
  }
  vec3 norm;
  if (!reduce_dispatch(push.reduction, square, norm)) return;
  if (gl_LocalInvocationID.x == 0u) push.state.at[0].norm = norm;
}
