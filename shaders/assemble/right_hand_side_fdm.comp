#version 460
#extension GL_GOOGLE_include_directive : require
#include "assemble/assembly_shared.h"
#include "material/optics.h"
#include "solver/fields.glsl"
#include "solver/stored_rows.glsl"
#include "shared/reduce.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { RightHandSideFdmPush push; };

// kappa_k q / (kappa_s d) at surface node `face`.
vec3 surface_load(uint face) {
  if (load_uint(push.face_kinds, face) != FACE_OPEN) return vec3(0);
  uint tet = load_uint(push.face_tets, face);
  float d = distance(load_vec3(push.nodes, tet), load_vec3(push.nodes, push.tet_count + face));
  vec3 kappa_ratio = kappa(load_optical(push.optical, tet)) / kappa(load_optical(push.optical, push.tet_count + face));
  return kappa_ratio * load_vec3(push.q, face) * load_scale(push.scale).inverse / d;
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  vec3 square = vec3(0);
  if (i < push.count) {
    Field b = diffuse_source(push.boundary, i < push.tet_count ? vec3(0) : surface_load(i - push.tet_count));
    push.b.at[i] = b;
    square = product(b, solved(load_diagonal(push.diagonal, i), b));
  }
  vec3 norm;
  if (!reduce_dispatch(push.reduction, square, norm)) return;
  if (gl_LocalInvocationID.x == 0u) push.state.at[0].norm = norm;
}
