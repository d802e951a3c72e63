#version 460
#extension GL_GOOGLE_include_directive : require
#include "deform/deform_shared.h"
#include "shared/stride.glsl"
#include "shared/reduce.glsl"
#include "solver/tet_volume.glsl"

// Looks at all tets and faces.
struct ShapeStatePush {
  Vec3s vertices;
  Uvec4s tets;
  Uvec3s faces;
  Uints face_kinds;
  Uints face_tets;
  ShapeSumsArray sums;  // per workgroup, written
  Vec2s samples;        // depth (mm) and area (mm^2) of every `step`-th face, written
  uint tet_count;
  uint face_count;
  uint step;
  LeastTet least;
};
layout(push_constant, scalar) uniform Block { ShapeStatePush push; };

shared float worst[WORKGROUP_SIZE];

struct TetState {
  float quality, conduction, volume;
};

// What the elements of an edge between two corners conduct, times its length squared.
float conducted(vec3 n_i, vec3 n_j, vec3 p_i, vec3 p_j) {
  return abs(dot(n_i, n_j)) * dot(p_i - p_j, p_i - p_j);
}

TetState state_of(uint t) {
  uvec4 tet = push.tets.at[t];
  vec3 p = push.vertices.at[tet.x], a = push.vertices.at[tet.y];
  vec3 b = push.vertices.at[tet.z], c = push.vertices.at[tet.w];
  vec3 n1 = cross(b - p, c - p), n2 = cross(c - p, a - p), n3 = cross(a - p, b - p);
  vec3 n0 = -(n1 + n2 + n3);
  float squares = dot(n0, n0) + dot(n1, n1) + dot(n2, n2) + dot(n3, n3), six_volume = dot(a - p, n1);
  float size = bounded_six_volume(six_volume, squares, push.least);
  float sum = conducted(n0, n1, p, a) + conducted(n0, n2, p, b) + conducted(n0, n3, p, c) + conducted(n1, n2, a, b) +
              conducted(n1, n3, a, c) + conducted(n2, n3, b, c);
  return TetState(tet_quality(six_volume, squares), 2.0 * sum / (6.0 * size), size / 6.0);
}

float area_of(uint f) {
  uvec3 ids = push.faces.at[f];
  vec3 p = push.vertices.at[ids.x];
  return 0.5 * length(cross(push.vertices.at[ids.y] - p, push.vertices.at[ids.z] - p));
}

// In invocation 0.
float least_of_group(float value) {
  uint lane = gl_LocalInvocationID.x;
  worst[lane] = value;
  barrier();
  for (uint k = 1u; k < WORKGROUP_SIZE && lane == 0u; ++k) value = min(value, worst[k]);
  return value;
}

void take_sample(uint f, float area) {
  float depth = 3.0 * state_of(push.face_tets.at[f]).volume / max(area, 1e-30);
  push.samples.at[f / push.step] = vec2(depth, area);
}

void main() {
  vec3 counts = vec3(0), sums = vec3(0);
  float least = 1.0;
  EACH(i, push.tet_count) {
    TetState state = state_of(i);
    counts += state.quality <= 0.0 ? vec3(1, 0, 0) : state.quality < push.least.quality ? vec3(0, 1, 0) : vec3(0);
    sums += vec3(state.conduction, state.volume, 0);
    least = min(least, state.quality);
  }
  EACH(f, push.face_count) {
    float area = area_of(f);
    if (is_open(push.face_kinds, f)) sums.z += area;
    if (f % push.step == 0u) take_sample(f, area);
  }
  counts = reduce_workgroup(counts);
  sums = reduce_workgroup(sums);
  least = least_of_group(least);
  if (gl_LocalInvocationID.x != 0u) return;
  push.sums.at[gl_WorkGroupID.x] = ShapeSums(counts.x, counts.y, least, sums.x, sums.y, sums.z);
}
