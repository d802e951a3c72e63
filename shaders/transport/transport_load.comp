#version 460
#extension GL_GOOGLE_include_directive : require
#define MOMENTS 1
#include "source/fixed_point.glsl"
#include "solver/right_hand_side.glsl"
#include "transport/transport_shared.h"

// b of the diffusion solve of one half, and its norm: what the samples have found, and what is kept of b before; what is
// missing in their sum is added in proportion to the light that is scattered.
struct TransportLoadPush {
  Uints load;     // fixed point: of the half, for all vertices what is added, then what is taken away
  Vec3s known;    // b before
  Vec3s mass;     // of transport_mass.comp
  Vec3s fluence;  // at the vertices
  Vec3s missing;  // one: of the half
  Vec3s unit;     // one: the scale of b before
  Scales scale;
  RightHandSideRef side;
  uint count;
  float share;  // of what was found that counts
  float keep;   // of b before
};
layout(push_constant, scalar) uniform Block { TransportLoadPush push; };

#include "transport/kept.glsl"

void main() {
  vec3 square = vec3(0);
  EACH(i, push.count) {
    vec3 found = push.share * (power_at(push.load, i) - power_at(push.load, push.count + i));
    vec3 scattered = push.mass.at[i] * max(push.fluence.at[i], vec3(0));
    square += store_b(push.side, i, lit(kept(push.known.at[i]) + found + push.missing.at[0] * scattered));
  }
  store_norm(push.side, square);
}
