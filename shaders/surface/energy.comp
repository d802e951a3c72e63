#version 460
#extension GL_GOOGLE_include_directive : require
#include "surface/surface_shared.h"
#include "solver/fields.glsl"
#include "shared/stride.glsl"
#include "shared/reduce.glsl"
#include "solver/tet_volume.glsl"

// Sums per workgroup over faces and tets; applies the factor of the clip to the exitance of the faces.
struct EnergyPush {
  Vec3s vertices;
  Uvec4s tets;
  Uvec3s faces;
  Uints face_kinds;
  Opticals optical;
  Floats etendue;  // as of BodyRef
  Fields x;
  Vec3s to_phi;
  Vec3s q;
  Vec3s exitance;
  Scales scale;
  Clips clip;
  Floats face_area;  // mm^2, written
  EnergySumsArray sums;
  uint tet_count;
  uint flags;  // ENERGY_*
  LeastTet least;
};
layout(push_constant, scalar) uniform Block { EnergyPush push; };

vec3 phi_at(uint carrier) {
  return element_or_one(push.to_phi, carrier) * push.x.at[carrier].phi;
}

vec3 absorbed(uint tet) {
  uvec4 corners = push.tets.at[tet];
  vec3 p = push.vertices.at[corners.x];
  vec3 e1 = push.vertices.at[corners.y] - p, e2 = push.vertices.at[corners.z] - p;
  vec3 e3 = push.vertices.at[corners.w] - p;
  float volume = number_or_one(push.etendue, tet) * tet_volume(e1, e2, e3, push.least);
  vec3 phi;
  if ((push.flags & ENERGY_ON_VERTICES) != 0u) {
    phi = 0.25 * (phi_at(corners.x) + phi_at(corners.y) + phi_at(corners.z) + phi_at(corners.w));
  } else {
    phi = phi_at(tet);
  }
  return push.optical.at[(push.flags & ENERGY_EVEN) != 0u ? 0u : tet].sigma_a * phi * push.scale.at[0].scale * volume;
}

void main() {
  EnergySums sums = EnergySums(vec3(0), vec3(0), vec3(0));
  EACH(i, push.tet_count) sums.absorbed += absorbed(i);
  EACH(i, faces_in(push.face_kinds)) {
    uvec3 corners = push.faces.at[i];
    vec3 p = push.vertices.at[corners.x];
    float area = 0.5 * length(cross(push.vertices.at[corners.y] - p, push.vertices.at[corners.z] - p));
    vec3 q = is_open(push.face_kinds, i) ? push.q.at[i] : vec3(0);
    vec3 exitance = push.exitance.at[i] * push.clip.at[0].factor;
    push.exitance.at[i] = exitance;
    push.face_area.at[i] = area;
    sums.entered += area * q;
    sums.exitance += area * exitance;
  }
  vec3 parts[3];
  parts[0] = sums.entered;
  parts[1] = sums.exitance;
  parts[2] = sums.absorbed;
  for (int k = 0; k < 3; ++k) parts[k] = reduce_workgroup(parts[k]);
  if (gl_LocalInvocationID.x == 0u) push.sums.at[gl_WorkGroupID.x] = EnergySums(parts[0], parts[1], parts[2]);
}
