#version 460
#extension GL_GOOGLE_include_directive : require
#include "exchange/exchange_shared.h"
#include "source/face_azimuth.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;

// Rows of the faces `first` to `first` + `count` - 1 modulo `face_count`, one workgroup each, of at
// most `rays` entries from face * rays on.
struct ExchangeRaysPush {
  Vec3s vertices;
  Uvec3s faces;
  Uints order;
  Uints leaf_begin;
  Boxes boxes;
  Uvec2s rows;    // written
  Uints entries;  // written
  uint first;
  uint face_count;
  uint leaf_count;
  uint rays;
};
layout(push_constant, scalar) uniform Block { ExchangeRaysPush push; };

#define TREE push
#define TREE_BODY push
#include "exchange/face_tree.glsl"

shared uint met_before[WORKGROUP_SIZE];

struct Frame {
  vec3 centre, t1, t2, normal;
};

Frame frame_of(uint face) {
  uvec3 ids = push.faces.at[face];
  vec3 a = push.vertices.at[ids.x], b = push.vertices.at[ids.y], c = push.vertices.at[ids.z];
  vec3 normal = normalize(cross(b - a, c - a)), t1 = normalize(b - a);
  return Frame((a + b + c) / 3.0, t1, cross(normal, t1), normal);
}

// Ray `i` of a face: cosine-weighted (docs/qgraph-format.md, "What the faces see").
Line ray_of(Frame frame, uint face, uint i) {
  float u = (float(i) + 0.5) / float(push.rays), azimuth = face_azimuth(face, i);
  vec3 d = normalize(sqrt(u) * (cos(azimuth) * frame.t1 + sin(azimuth) * frame.t2) + sqrt(1.0 - u) * frame.normal);
  return line_along(frame.centre, d);
}

// The face that a ray from `own` meets first and from outside, or NO_FACE.
uint met_outside(Line ray, uint own) {
  Hit hit = first_met(ray, own, FAR);
  return hit.outside ? hit.face : NO_FACE;
}

// Rays of this workgroup up to this one that met something.
uint count_met(bool met) {
  uint lane = gl_LocalInvocationID.x;
  met_before[lane] = met ? 1u : 0u;
  barrier();
  for (uint step = 1u; step < WORKGROUP_SIZE; step *= 2u) {
    uint more = lane >= step ? met_before[lane - step] : 0u;
    barrier();
    met_before[lane] += more;
    barrier();
  }
  return met_before[lane];
}

void main() {
  uint face = (push.first + gl_WorkGroupID.x) % push.face_count;
  Frame frame = frame_of(face);
  uint end = face * push.rays;
  for (uint first = 0u; first < push.rays; first += WORKGROUP_SIZE) {
    uint i = first + gl_LocalInvocationID.x;
    uint met = i < push.rays ? met_outside(ray_of(frame, face, i), face) : NO_FACE;
    uint number = count_met(met != NO_FACE);
    if (met != NO_FACE) push.entries.at[end + number - 1u] = met;
    end += met_before[WORKGROUP_SIZE - 1];
    barrier();
  }
  if (gl_LocalInvocationID.x == 0u) push.rows.at[face] = uvec2(face * push.rays, end);
}
