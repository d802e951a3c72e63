#version 460
#extension GL_GOOGLE_include_directive : require
#include "transport/transport_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// Exitance per face and half by the transport equation, of light that was scattered.
struct TransportExitancePush {
  TransportFieldRefs field;  // one
  Vec3s exitance;            // W/mm^2: of the first half for all faces, then of the second
  uint rays;                 // per face and half
  uint seed;
};
layout(push_constant, scalar) uniform Block { TransportExitancePush push; };

TransportFieldRef field;
#define FIELD field
#include "transport/transport_ray.glsl"

const float TWO_PI = 6.2831853;

struct Surface {
  uint face, tet;
  uvec3 ids;
  mat3 corners;
  vec3 normal, tangent, side;
};

// One of the rays, whose outside cosines are cosine-weighted by strata.
vec3 leaving(Surface at, float stratum, float azimuth, inout uint state) {
  float u = (stratum + uniform_number(state)) / float(push.rays);
  float s = sqrt(uniform_number(state)), t = uniform_number(state);
  float cosine = sqrt(1.0 - (1.0 - u) / (BODY.eta * BODY.eta));
  vec3 across = cos(azimuth) * at.tangent + sin(azimuth) * at.side;
  vec3 inside = normalize(sqrt(1.0 - u) / BODY.eta * across - cosine * at.normal);
  start_on_face(at.tet, at.ids, at.corners, vec3(1.0 - s, s * (1.0 - t), s * t));
  return fresnel_transmittance(sqrt(u), BODY.eta) * arriving(at.tet, inside, state);
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  field = push.field.at[0];
  crossed = 0u;
  if (i >= TRANSPORT_HALVES * BODY.face_count) return;
  push.exitance.at[i] = vec3(0);
  Surface at;
  at.face = i % BODY.face_count;
  if (BODY.face_kinds.at[at.face] != FACE_OPEN) return;
  at.ids = BODY.faces.at[at.face];
  at.corners = corners_of(at.ids);
  vec3 doubled = cross(at.corners[1] - at.corners[0], at.corners[2] - at.corners[0]);
  if (doubled == vec3(0)) return;
  at.normal = normalize(doubled);
  at.tangent = normalize(at.corners[1] - at.corners[0]);
  at.side = cross(at.normal, at.tangent);
  at.tet = BODY.face_tets.at[at.face];
  uint state = hash(i ^ hash(push.seed));
  float turned = TWO_PI * uniform_number(state);
  vec3 sum = vec3(0);
  for (uint k = 0u; k < push.rays; ++k) sum += leaving(at, float(k), turned + GOLDEN_ANGLE * float(k), state);
  push.exitance.at[i] = sum / (4.0 * BODY.eta * BODY.eta * float(push.rays));
  atomicAdd(field.segments.at[0], crossed);
}
