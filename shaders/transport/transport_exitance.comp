#version 460
#extension GL_GOOGLE_include_directive : require
#include "source/fixed_point.glsl"
#include "transport/transport_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// Exitance per face and half by the transport equation, of light that was scattered, added to what is kept of it.
struct TransportExitancePush {
  TransportFieldRefs field;  // one
  Vec3s exitance;            // W/mm^2, scaled: of the first half for all faces, then of the second
  Uints sums;                // fixed point, WALK_SUMS times four, as TransportBooksPush has it
  Vec3s unit;                // one: the scale of what is kept
  Scales scale;
  uint rays;  // per face and half
  uint seed;
  float keep;  // share of what is kept
};
layout(push_constant, scalar) uniform Block { TransportExitancePush push; };

TransportFieldRef field;
#define FIELD field
#include "transport/kept.glsl"
#define LEAST_LEFT 0.05
#include "transport/transport_ray.glsl"

struct Surface {
  uint face, tet;
  uvec3 ids;
  mat3 corners;
  vec3 normal, tangent, side;
  float area;
  OpticalSurface surface;
};

vec3 left, entered_again;  // of the face, over its area

// One of the rays, whose outside cosines are cosine-weighted by strata.
void add_leaving(Surface at, float stratum, float azimuth, inout uint state) {
  float u = (stratum + uniform_number(state)) / float(push.rays);
  float s = sqrt(uniform_number(state)), t = uniform_number(state);
  vec3 across = cos(azimuth) * at.tangent + sin(azimuth) * at.side;
  vec3 outside = sqrt(u) * at.normal - sqrt(1.0 - u) * across;
  vec3 inside = way_in(-outside, at.normal, at.normal, at.surface, state);
  vec3 l = vec3(1.0 - s, s * (1.0 - t), s * t);
  vec3 before, now = arriving(ray_from(start_on_face(at.tet, at.ids, l), inside, hash(state)), before);
  vec3 leaves = surface_transmittance(sqrt(u), at.surface) * (now - before);
  left += leaves;
  if (!sees_body(at.face)) return;
  Entrance entry = through_air(at.face, at.corners * l, outside, state);
  if (entry.face != NO_FACE) entered_again += leaves;
}

void add_sums(float area) {
  uint at = 4u * (gl_WorkGroupID.x % WALK_SUMS);
  add_signed(push.sums, at, 1u, area * left);
  add_signed(push.sums, at + 2u, 1u, area * entered_again);
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  field = push.field.at[0];
  crossed = 0u;
  if (i >= TRANSPORT_HALVES * BODY.face_count) return;
  Surface at;
  at.face = i % BODY.face_count;
  if (!is_open(BODY.face_kinds, at.face)) return;
  at.ids = BODY.faces.at[at.face];
  at.corners = mat3(BODY.vertices.at[at.ids.x], BODY.vertices.at[at.ids.y], BODY.vertices.at[at.ids.z]);
  vec3 doubled = cross(at.corners[1] - at.corners[0], at.corners[2] - at.corners[0]);
  if (doubled == vec3(0)) return;
  at.normal = normalize(doubled);
  at.area = 0.5 * length(doubled);
  at.tangent = normalize(at.corners[1] - at.corners[0]);
  at.side = cross(at.normal, at.tangent);
  at.tet = BODY.face_tets.at[at.face];
  at.surface = surface_of(BODY.face_kinds, at.face);
  uint state = hash(i ^ hash(push.seed));
  float turned = TWO_PI * uniform_number(state);
  left = vec3(0);
  entered_again = vec3(0);
  for (uint k = 0u; k < push.rays; ++k) add_leaving(at, float(k), turned + GOLDEN_ANGLE * float(k), state);
  float share = 1.0 / (4.0 * at.surface.eta * at.surface.eta * float(push.rays));
  push.exitance.at[i] = kept(push.exitance.at[i]) + share * left;
  add_sums(share * at.area);
  atomicAdd(field.segments.at[0], crossed);
}
