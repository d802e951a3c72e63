#version 460
#extension GL_GOOGLE_include_directive : require
#include "transport/transport_shared.h"
#include "solver/fields.glsl"
#include "source/fixed_point.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// Fluence at the vertices, of a solution, and of light that enters again and has not scattered since: for the transport
// equation that is the fluence of what scatters elsewhere. To it comes what sweeps added to the solution before; after
// sweeps, a share of what they changed.
struct TransportFluencePush {
  Fields x;
  Vec3s to_phi;  // null: 1
  Vec3s fluence;
  Vec3s added;  // of transport_step.comp; brought to the present scale
  Vec3s unit;   // one: the scale that it had
  Scales scale;
  Vec3s mass;   // of transport_mass.comp
  Uints first;  // fixed point: power scattered for the first time, of the scene's light
  Uints all;    // and with that of light that enters again; the same where there is none
  uint count;
  float keep;   // 1: of `added` all, 0: nothing
  float taken;  // that share
  uint swept;   // 1: after sweeps, 0: before them
};
layout(push_constant, scalar) uniform Block { TransportFluencePush push; };

#include "transport/kept.glsl"

void main() {
  uint v = gl_GlobalInvocationID.x;
  if (v >= push.count) return;
  vec3 again = max(power_at(push.all, v) - power_at(push.first, v), vec3(0)), mass = push.mass.at[v];
  vec3 unscattered = mix(again / mass, vec3(0), equal(mass, vec3(0)));
  vec3 solved = element_or_one(push.to_phi, v) * push.x.at[v].phi + unscattered;
  if (push.swept == 1u) {
    push.fluence.at[v] = mix(solved, push.fluence.at[v], push.taken);
    return;
  }
  vec3 added = kept(push.added.at[v]);
  push.added.at[v] = added;
  push.fluence.at[v] = solved + added;
}
