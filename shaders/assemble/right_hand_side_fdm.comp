#version 460
#extension GL_GOOGLE_include_directive : require
#include "assemble/assembly_shared.h"
#include "material/optics.h"
#include "solver/fields.glsl"
#include "solver/stored_rows.glsl"
#include "shared/stride.glsl"
#include "shared/reduce.glsl"

// Scaled b at every node, and its norm.
struct RightHandSideFdmPush {
  Vec3s nodes;
  Opticals optical;
  Uints face_tets;
  Uints face_kinds;
  Vec3s q;
  Scales scale;
  Entries diagonal;
  Fields b;
  SolveStates state;
  Reduction reduction;
  uint count;
  uint tet_count;
  Boundary boundary;
};
layout(push_constant, scalar) uniform Block { RightHandSideFdmPush push; };

// kappa_k q / (kappa_s d) at surface node `face`.
vec3 surface_load(uint face) {
  if (push.face_kinds.at[face] != FACE_OPEN) return vec3(0);
  uint tet = push.face_tets.at[face];
  float d = distance(push.nodes.at[tet], push.nodes.at[push.tet_count + face]);
  vec3 kappa_ratio = kappa(push.optical.at[tet]) / kappa(push.optical.at[push.tet_count + face]);
  return kappa_ratio * push.q.at[face] * push.scale.at[0].inverse / d;
}

void main() {
  vec3 square = vec3(0);
  EACH(i, push.count) {
    Field b = diffuse_source(push.boundary, i < push.tet_count ? vec3(0) : surface_load(i - push.tet_count));
    push.b.at[i] = b;
    square += product(b, solved(load_diagonal(push.diagonal, i), b));
  }
  vec3 norm;
  if (!reduce_dispatch(push.reduction, square, norm)) return;
  if (gl_LocalInvocationID.x == 0u) push.state.at[0].norm = norm;
}
