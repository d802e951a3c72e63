#version 460
#extension GL_GOOGLE_include_directive : require
#include "transport/transport_shared.h"
#include "surface/surface_shared.h"
#include "shared/stride.glsl"
#include "shared/reduce.glsl"
#include "shared/face_area.glsl"

// Phi and exitance per face of what was corrected, of whose change a share is taken. Negative values count as 0, and the
// factor is found that restores the power, as in exitance.comp.
struct TransportResultPush {
  Vec3s vertices;
  Uvec3s faces;
  Uints face_kinds;
  Vec3s fluence;    // at the vertices
  Scales scale;
  Vec3s corrected;  // exitance, W/mm^2
  Vec3s phi;        // W/mm^2, written
  Vec3s q;          // W/mm^2, of the lights
  Vec3s exitance;   // of the solve, then of the result
  Clips clip;
  Reduction reduction;
  uint count;
  float taken_lit;  // the share, where light enters and where none does
  float taken_unlit;
};
layout(push_constant, scalar) uniform Block { TransportResultPush push; };

void main() {
  vec3 added = vec3(0), positive = vec3(0);  // integrals over the face
  EACH(f, push.count) {
    uvec3 ids = push.faces.at[f];
    vec3 phi = (push.fluence.at[ids.x] + push.fluence.at[ids.y] + push.fluence.at[ids.z]) / 3.0;
    bool open = is_open(push.face_kinds, f);
    push.phi.at[f] = open ? phi * push.scale.at[0].scale : vec3(0);
    vec3 m = open ? push.corrected.at[f] : vec3(0);
    vec3 taken = max(mix(push.exitance.at[f], m, push.q.at[f] == vec3(0) ? push.taken_unlit : push.taken_lit), vec3(0));
    push.exitance.at[f] = taken;
    float area = area_of(push.faces, push.vertices, f);
    added += area * (taken - m);
    positive += area * taken;
  }
  vec3 total_added, total_positive;
  if (!reduce_dispatch_pair(push.reduction, added, positive, total_added, total_positive)) return;
  if (gl_LocalInvocationID.x != 0u) return;
  vec3 share = mix(vec3(0), min(total_added / total_positive, vec3(1)), greaterThan(total_positive, vec3(0)));
  push.clip.at[0] = Clip(1.0 - share, share);
}
