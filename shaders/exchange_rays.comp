#version 460
#extension GL_GOOGLE_include_directive : require
#include "exchange_shared.h"
#include "face_azimuth.glsl"

layout(local_size_x = WORKGROUP_SIZE) in;
layout(push_constant, scalar) uniform Block { ExchangeRaysPush push; };

const uint NONE = 0xFFFFFFFFu;
const float FAR = 1e37;
// Barycentric distance by which a face reaches over its edges, so that no ray slips through between two.
const float OVERLAP = 1e-6;

shared uint met_before[WORKGROUP_SIZE];

struct Ray {
  vec3 origin, direction, inverse;  // mm, unit, 1 / direction
};

struct Hit {
  float distance;  // mm
  uint face;
  bool outside;  // seen from its outside
};

struct Frame {
  vec3 centre, t1, t2, normal;
};

Frame frame_of(uint face) {
  uvec3 ids = load_uvec3(push.faces, face);
  vec3 a = load_vec3(push.vertices, ids.x), b = load_vec3(push.vertices, ids.y), c = load_vec3(push.vertices, ids.z);
  vec3 normal = normalize(cross(b - a, c - a)), t1 = normalize(b - a);
  return Frame((a + b + c) / 3.0, t1, cross(normal, t1), normal);
}

// Ray `i` of a face: cosine-weighted (docs/qgraph-format.md, "What the faces see").
Ray ray_of(Frame frame, uint face, uint i) {
  float u = (float(i) + 0.5) / float(push.rays), azimuth = face_azimuth(face, i);
  vec3 d = normalize(sqrt(u) * (cos(azimuth) * frame.t1 + sin(azimuth) * frame.t2) + sqrt(1.0 - u) * frame.normal);
  vec3 finite = mix(d, vec3(1e-20), lessThan(abs(d), vec3(1e-20)));
  return Ray(frame.centre, d, 1.0 / finite);
}

// Moeller and Trumbore 1997, about the origin of the ray.
void meet(Ray ray, uint face, inout Hit hit) {
  uvec3 ids = load_uvec3(push.faces, face);
  vec3 first = load_vec3(push.vertices, ids.x), a = first - ray.origin;
  vec3 ab = load_vec3(push.vertices, ids.y) - first, ac = load_vec3(push.vertices, ids.z) - first;
  vec3 p = cross(ray.direction, ac);
  float det = dot(ab, p);
  if (det == 0.0) return;
  float u = -dot(a, p) / det;
  vec3 q = cross(ab, a);
  float v = dot(ray.direction, q) / det, distance = dot(ac, q) / det;
  if (u < -OVERLAP || v < -OVERLAP || u + v > 1.0 + OVERLAP || distance <= 0.0 || distance >= hit.distance) return;
  hit = Hit(distance, face, det > 0.0);
}

bool may_meet(Ray ray, Box box, float least) {
  vec3 a = (box.low - ray.origin) * ray.inverse, b = (box.high - ray.origin) * ray.inverse;
  vec3 near = min(a, b), far = max(a, b);
  float enter = max(max(near.x, near.y), max(near.z, 0.0));
  float leave = min(min(far.x, far.y), far.z) * 1.000001;  // beyond all rounding
  return enter <= min(leave, least);
}

// The face that a ray from `own` meets first and from outside, or NONE.
uint first_met(Ray ray, uint own) {
  Hit hit = Hit(FAR, NONE, false);
  uint node = 1u;
  while (node != 0u) {
    if (may_meet(ray, load_box(push.boxes, node), hit.distance)) {
      if (node < push.leaf_count) {
        node *= 2u;
        continue;
      }
      uint leaf = node - push.leaf_count;
      for (uint k = load_uint(push.leaf_begin, leaf); k < load_uint(push.leaf_begin, leaf + 1u); ++k) {
        uint face = load_uint(push.order, k);
        if (face != own) meet(ray, face, hit);
      }
    }
    // On to the next subtree to the right; a path of right turns alone was the last.
    while ((node & 1u) == 1u) node >>= 1u;
    if (node != 0u) ++node;
  }
  return hit.outside ? hit.face : NONE;
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
    uint met = i < push.rays ? first_met(ray_of(frame, face, i), face) : NONE;
    uint number = count_met(met != NONE);
    if (met != NONE) push.entries.at[end + number - 1u] = met;
    end += met_before[WORKGROUP_SIZE - 1];
    barrier();
  }
  if (gl_LocalInvocationID.x == 0u) push.rows.at[face] = uvec2(face * push.rays, end);
}
