#version 460
#extension GL_GOOGLE_include_directive : require
#include "transport/element_loss.h"
#include "transport/transport_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// Exitance per face after a sweep, J = G + k11 delta times its gain, of both halves, and their mean over the share of it
// that elements as deep as the face's let sweeps see.
struct TransportFacesPush {
  Vec3s vertices;  // mm
  Uvec4s tets;
  Uvec3s faces;
  Uints face_tets;
  Opticals optical;  // per tet, or one
  Uints face_kinds;
  Boundaries boundaries;  // of the correction, by body
  Scales scale;
  Vec3s gathered;  // of transport_exitance.comp
  Vec3s change_a;  // fluence at the vertices that the solves of both halves add
  Vec3s change_b;
  TransportBooks books;
  Vec3s halves;    // of the first half for all faces, then of the second, W/mm^2, written
  Vec3s exitance;  // W/mm^2, written
  uint count;
  uint even;  // 1: optical is the same everywhere
};
layout(push_constant, scalar) uniform Block { TransportFacesPush push; };

// Height of the tet behind a face over it, mm.
float depth_of(uint f, uint t) {
  uvec3 ids = push.faces.at[f];
  vec3 p = push.vertices.at[ids.x];
  vec3 doubled = cross(push.vertices.at[ids.y] - p, push.vertices.at[ids.z] - p);
  uvec4 tet = push.tets.at[t];
  // Three of its corners lie in the face: the sum over all is that of the fourth.
  float height = 0.0;
  for (uint k = 0u; k < 4u; ++k) height += abs(dot(doubled, push.vertices.at[tet[k]] - p));
  return height / max(length(doubled), 1e-30);
}

void main() {
  uint f = gl_GlobalInvocationID.x;
  if (f >= push.count || !is_open(push.face_kinds, f)) return;
  uvec3 ids = push.faces.at[f];
  vec3 change_a = vec3(0), change_b = vec3(0);
  for (uint k = 0u; k < 3u; ++k) {
    change_a += push.change_a.at[ids[k]] / 3.0;
    change_b += push.change_b.at[ids[k]] / 3.0;
  }
  float k11 = push.boundaries.at[body_behind(push.face_kinds, f)].k11;
  vec3 unit = push.scale.at[0].scale, gain = k11 * push.books.at[0].gain;
  vec3 a = unit * (push.gathered.at[f] + gain * change_a);
  vec3 b = unit * (push.gathered.at[push.count + f] + gain * change_b);
  push.halves.at[f] = a;
  push.halves.at[push.count + f] = b;
  uint t = push.face_tets.at[f];
  Optical optical = push.optical.at[push.even == 1u ? 0u : t];
  push.exitance.at[f] = 0.5 * (a + b) / seen_of_element(optical, depth_of(f, t), eta_behind(push.face_kinds, f));
}
