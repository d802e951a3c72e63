#version 460
#extension GL_GOOGLE_include_directive : require
#include "gather/gather_shared.h"
#include "transport/transport_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// Where light goes at the vertices, for view rays. Behind gather_lacking.comp.
struct GatherFlowPush {
  TransportForwardRefs forward;  // one
  GatherPoints points;
  Vec3s fluence;  // of the correction, at the vertices, scaled
  Vec3s flux;     // the same
  Scales scale;
  Vec3s flows;  // of ForwardLight, written
};
layout(push_constant, scalar) uniform Block { GatherFlowPush push; };

TransportForwardRef forward;
#define FORWARD forward
#include "transport/forward.glsl"

void main() {
  uint v = gl_GlobalInvocationID.x;
  forward = push.forward.at[0];
  if (v >= forward.vertex_count) return;
  vec3 first = vec3(0);
  mat3 towards = mat3(0.0);
  for (uint k = forward.tet_offset.at[v]; k < forward.tet_offset.at[v + 1u]; ++k) {
    uint tet = forward.tet_incidence.at[k];
    first += first_of(forward.deposit, tet);
    towards += first_towards(tet);
  }
  mat3 ways = directions_of(first, towards);
  vec3 unit = push.scale.at[0].scale, c = 3.0 * cosine_beside_peak(forward.beside.g);
  vec3 lacking = push.points.at[v].phi.xyz - unit * push.fluence.at[v];
  mat3 flow = scaled_by(c * unit, flux_at(push.flux, v)) + scaled_by(c * lacking, ways);
  for (uint axis = 0u; axis < 3u; ++axis) {
    push.flows.at[GATHER_FLOWS * v + axis] = flow[axis];
    push.flows.at[GATHER_FLOWS * v + 3u + axis] = ways[axis];
  }
}
