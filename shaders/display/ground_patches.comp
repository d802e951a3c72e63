#version 460
#extension GL_GOOGLE_include_directive : require
#include "display/ground_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// What leaves each patch of the surface: of faces that lie together, `order` says which.
struct GroundPatchesPush {
  Vec3s vertices;  // mm
  Uvec3s faces;
  Uints face_kinds;
  Vec3s exitance;         // per face, W/mm^2
  Uints order;            // every face once
  GroundPatches patches;  // written
  uint face_count;
  uint patch_faces;  // in each patch but the last
};
layout(push_constant, scalar) uniform Block { GroundPatchesPush push; };

void main() {
  uint p = gl_GlobalInvocationID.x;
  if (p >= (push.face_count + push.patch_faces - 1u) / push.patch_faces) return;
  uint begin = p * push.patch_faces, end = min(begin + push.patch_faces, push.face_count);
  GroundPatch sum = GroundPatch(vec3(0), 0.0, vec3(0), vec3(0), vec3(0), vec3(0));
  for (uint k = begin; k < end; ++k) {
    uint face = push.order.at[k];
    if (!is_open(push.face_kinds, face)) continue;
    uvec3 corners = push.faces.at[face];
    vec3 a = push.vertices.at[corners.x], b = push.vertices.at[corners.y], c = push.vertices.at[corners.z];
    vec3 facing = 0.5 * cross(b - a, c - a), exitance = max(push.exitance.at[face], vec3(0));
    float area = length(facing);
    sum.area += area;
    sum.place += area / 3.0 * (a + b + c);
    sum.facing += facing;
    sum.red += exitance.x * facing;
    sum.green += exitance.y * facing;
    sum.blue += exitance.z * facing;
  }
  if (sum.area > 0.0) sum.place /= sum.area;
  push.patches.at[p] = sum;
}
