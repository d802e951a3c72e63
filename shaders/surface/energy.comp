#version 460
#extension GL_GOOGLE_include_directive : require
#include "surface/surface_shared.h"
#include "solver/fields.glsl"
#include "shared/stride.glsl"
#include "shared/reduce.glsl"
#include "solver/tet_volume.glsl"

layout(push_constant, scalar) uniform Block { EnergyPush push; };

vec3 phi_at(uint carrier) {
  return load_vec3_or_one(push.to_phi, carrier) * load_field(push.x, carrier).phi;
}

vec3 absorbed(uint tet) {
  uvec4 corners = load_uvec4(push.tets, tet);
  vec3 p = load_vec3(push.vertices, corners.x);
  vec3 e1 = load_vec3(push.vertices, corners.y) - p, e2 = load_vec3(push.vertices, corners.z) - p;
  vec3 e3 = load_vec3(push.vertices, corners.w) - p;
  float volume = tet_volume(e1, e2, e3, push.least);
  vec3 phi;
  if (push.fem == 1u) {
    phi = 0.25 * (phi_at(corners.x) + phi_at(corners.y) + phi_at(corners.z) + phi_at(corners.w));
  } else {
    phi = phi_at(tet);
  }
  return load_optical(push.optical, push.even == 1u ? 0u : tet).sigma_a * phi * load_scale(push.scale).scale * volume;
}

void main() {
  EnergySums sums = EnergySums(vec3(0), vec3(0), vec3(0));
  EACH(i, push.tet_count) sums.absorbed += absorbed(i);
  EACH(i, push.face_count) {
    uvec3 corners = load_uvec3(push.faces, i);
    vec3 p = load_vec3(push.vertices, corners.x);
    float area = 0.5 * length(cross(load_vec3(push.vertices, corners.y) - p, load_vec3(push.vertices, corners.z) - p));
    vec3 q = load_uint(push.face_kinds, i) == FACE_OPEN ? load_vec3(push.q, i) : vec3(0);
    vec3 exitance = load_vec3(push.exitance, i) * push.clip.at[0].factor;
    push.exitance.at[i] = exitance;
    sums.entered += area * q;
    sums.exitance += area * exitance;
  }
  vec3 parts[3] = vec3[](sums.entered, sums.exitance, sums.absorbed);
  [[dont_unroll]] for (int k = 0; k < 3; ++k) parts[k] = reduce_workgroup(parts[k]);
  if (gl_LocalInvocationID.x == 0u) push.sums.at[gl_WorkGroupID.x] = EnergySums(parts[0], parts[1], parts[2]);
}
