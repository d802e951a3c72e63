#version 460
#extension GL_GOOGLE_include_directive : require
#include "deform_shared.h"
#include "reduce.glsl"
#include "tet_volume.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
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
  uvec4 tet = load_uvec4(push.tets, t);
  vec3 p = load_vec3(push.vertices, tet.x), a = load_vec3(push.vertices, tet.y);
  vec3 b = load_vec3(push.vertices, tet.z), c = load_vec3(push.vertices, tet.w);
  vec3 n1 = cross(b - p, c - p), n2 = cross(c - p, a - p), n3 = cross(a - p, b - p);
  vec3 n0 = -(n1 + n2 + n3);
  float squares = dot(n0, n0) + dot(n1, n1) + dot(n2, n2) + dot(n3, n3), six_volume = dot(a - p, n1);
  float size = bounded_six_volume(six_volume, squares, push.least);
  float sum = conducted(n0, n1, p, a) + conducted(n0, n2, p, b) + conducted(n0, n3, p, c) + conducted(n1, n2, a, b) +
              conducted(n1, n3, a, c) + conducted(n2, n3, b, c);
  return TetState(tet_quality(six_volume, squares), 2.0 * sum / (6.0 * size), size / 6.0);
}

float area_of(uint f) {
  uvec3 ids = load_uvec3(push.faces, f);
  vec3 p = load_vec3(push.vertices, ids.x);
  return 0.5 * length(cross(load_vec3(push.vertices, ids.y) - p, load_vec3(push.vertices, ids.z) - p));
}

float least_of_group(float value) {
  uint lane = gl_LocalInvocationID.x;
  worst[lane] = value;
  barrier();
  for (uint half_size = WORKGROUP_SIZE / 2u; half_size > 0u; half_size /= 2u) {
    if (lane < half_size) worst[lane] = min(worst[lane], worst[lane + half_size]);
    barrier();
  }
  return worst[0];
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  TetState state = TetState(1.0, 0.0, 0.0);
  if (i < push.tet_count) state = state_of(i);
  float area = 0.0;
  if (i < push.face_count) {
    float size = area_of(i);
    if (load_uint(push.face_kinds, i) == FACE_OPEN) area = size;
    if (i % push.step == 0u) {
      float depth = 3.0 * state_of(load_uint(push.face_tets, i)).volume / max(size, 1e-30);
      push.samples.at[i / push.step] = vec2(depth, size);
    }
  }
  bool inverted = state.quality <= 0.0, nearly_flat = !inverted && state.quality < push.least.quality;
  vec3 counts = reduce_workgroup(vec3(inverted ? 1.0 : 0.0, nearly_flat ? 1.0 : 0.0, 0.0));
  vec3 sums = reduce_workgroup(vec3(state.conduction, state.volume, area));
  float least = least_of_group(state.quality);
  if (gl_LocalInvocationID.x != 0u) return;
  push.sums.at[gl_WorkGroupID.x] = ShapeSums(counts.x, counts.y, least, sums.x, sums.y, sums.z);
}
