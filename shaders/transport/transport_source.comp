#version 460
#extension GL_GOOGLE_include_directive : require
#include "transport/first_scattered.glsl"
#include "transport/transport_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// The light that samples see: a share of the present field, less one of the field before, for which their results are
// known. All that is sampled is linear in it, so that what is known of the one before is used again, and the noise is that
// of the difference (docs/physics.md, "Transport correction").
struct TransportSourcePush {
  Vec2s weights;  // of transport_weights.comp
  Uvec4s tets;
  Opticals optical;
  Vec3s fluence;         // at the vertices
  Uints deposit;         // fixed point, at the corners of the tets, four each: power scattered for the first time
  Vec3s fluence_before;  // those before, which the present ones replace
  Vec3s source_before;   // light that is scattered, four per tet, W/mm^3
  Vec3s unit;            // one: the scale that these have
  Scales scale;
  Vec3s fluence_seen;   // written
  Vec3s fluence_apart;  // written: what of the field before is seen by itself; or null, where it is taken away
  Vec3s source_apart;   // the same, four per tet
  TetSources sources;
  uint vertex_count;
  uint tet_count;
  uint even;    // 1: optical is the same everywhere
  float share;  // of the present field
  float keep;   // of that before
};
layout(push_constant, scalar) uniform Block { TransportSourcePush push; };

#include "transport/kept.glsl"

bool apart() {
  return uvec2(push.source_apart) != uvec2(0);
}

// At a corner.
vec3 source_at(uint tet, uint corner, uint vertex, vec3 sum, float per_volume) {
  vec3 first = first_at(push.deposit, tet, corner, sum, per_volume);
  vec3 present = push.optical.at[push.even == 1u ? 0u : tet].sigma_s_prime * push.fluence.at[vertex] + first;
  uint at = 4u * tet + corner;
  vec3 before = kept(push.source_before.at[at]);
  push.source_before.at[at] = present;
  if (!apart()) return push.share * present - before;
  push.source_apart.at[at] = before;
  return push.share * present;
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i < push.vertex_count) {
    vec3 present = push.fluence.at[i], before = kept(push.fluence_before.at[i]);
    push.fluence_before.at[i] = present;
    push.fluence_seen.at[i] = push.share * present - (apart() ? vec3(0) : before);
    if (apart()) push.fluence_apart.at[i] = before;
  }
  if (i >= push.tet_count) return;
  uvec4 corners = push.tets.at[i];
  float per_volume = per_volume_of(push.weights.at[i].y);
  vec3 sum = first_of(push.deposit, i);
  push.sources.at[i].source_0 = vec4(source_at(i, 0u, corners.x, sum, per_volume), 0.0);
  push.sources.at[i].source_1 = vec4(source_at(i, 1u, corners.y, sum, per_volume), 0.0);
  push.sources.at[i].source_2 = vec4(source_at(i, 2u, corners.z, sum, per_volume), 0.0);
  push.sources.at[i].source_3 = vec4(source_at(i, 3u, corners.w, sum, per_volume), 0.0);
}
