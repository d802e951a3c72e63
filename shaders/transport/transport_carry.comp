#version 460
#extension GL_GOOGLE_include_directive : require
#include "transport/transport_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// Brings what faces have gathered before the vertices moved to the present fluence: by how much that lets out more than
// the fluence before. What is averaged from there on is the difference between transport and fluence alone.
struct TransportCarryPush {
  Uvec3s faces;
  Uints face_kinds;
  Boundaries boundaries;  // of the correction, by body
  Vec3s fluence;         // at the vertices
  Vec3s fluence_before;  // of the frame before
  Vec3s unit;            // one: the scale that these and what was gathered have
  Scales scale;
  Vec3s gathered;  // of transport_exitance.comp, both halves
  uint count;
};
layout(push_constant, scalar) uniform Block { TransportCarryPush push; };

void main() {
  uint f = gl_GlobalInvocationID.x;
  if (f >= push.count || !is_open(push.face_kinds, f)) return;
  vec3 unit = push.unit.at[0], present = push.scale.at[0].scale / mix(unit, vec3(1), equal(unit, vec3(0)));
  uvec3 ids = push.faces.at[f];
  vec3 more = vec3(0);
  for (uint k = 0u; k < 3u; ++k) {
    more += (present * push.fluence.at[ids[k]] - push.fluence_before.at[ids[k]]) / 3.0;
  }
  float k11 = push.boundaries.at[body_behind(push.face_kinds, f)].k11;
  push.gathered.at[f] += k11 * more;
  push.gathered.at[push.count + f] += k11 * more;
}
