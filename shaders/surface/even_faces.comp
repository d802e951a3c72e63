#version 460
#extension GL_GOOGLE_include_directive : require
#include "surface/near_return.h"
#include "surface/surface_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// What of the exitance of every face is made even.
struct EvenFacesPush {
  Vec3s vertices;  // mm
  Uvec3s faces;
  Uints face_tets;
  Uints face_kinds;
  Opticals optical;  // per tet
  Vec3s q;           // W/mm^2, of the lights
  Vec3s exitance;    // W/mm^2
  EvenFaces even;    // written
  uint count;
  uint same_everywhere;  // 1: optical is
};
layout(push_constant, scalar) uniform Block { EvenFacesPush push; };

void main() {
  uint f = gl_GlobalInvocationID.x;
  if (f >= push.count) return;
  uvec3 ids = push.faces.at[f];
  vec3 p = push.vertices.at[ids.x];
  vec3 ab = push.vertices.at[ids.y] - p, ac = push.vertices.at[ids.z] - p, bc = ac - ab, doubled = cross(ab, ac);
  float edge = sqrt((dot(ab, ab) + dot(ac, ac) + dot(bc, bc)) / 3.0), size = length(doubled);
  Optical optical = push.optical.at[push.same_everywhere == 1u ? 0u : push.face_tets.at[f]];
  vec3 exitance = push.exitance.at[f], q = push.q.at[f];
  vec3 near = min(near_return(optical, refraction_behind(push.face_kinds, f).kept) * q, exitance);
  push.even.at[f] = EvenFace(exitance - near, evened_share(optical, edge), doubled / max(size, 1e-30), 0.5 * size,
                             q == vec3(0) ? 0u : 1u);
}
