// Faces that a line meets. The shader that includes it defines first
//   TREE      what has order, leaf_begin, boxes and leaf_count, e.g. a TreeRef
//   TREE_BODY what has vertices and faces
#ifndef QUADGRAPH_FACE_TREE_GLSL
#define QUADGRAPH_FACE_TREE_GLSL

#include "shared/body_shared.h"

#ifndef TREE
#error "face_tree.glsl: TREE is not defined"
#endif
#ifndef TREE_BODY
#error "face_tree.glsl: TREE_BODY is not defined"
#endif

const uint NO_FACE = 0xFFFFFFFFu;
const float FAR = 1e37;
// Barycentric distance by which a face reaches over its edges, so that no line slips through between two.
const float OVERLAP = 1e-6;

struct Line {
  vec3 origin, direction, inverse;  // mm, unit, 1 / direction
};

struct Hit {
  float distance;  // mm
  uint face;       // or NO_FACE
  bool outside;    // seen from its outside
  vec2 place;      // barycentric coordinates of its second and third corner
};

Line line_along(vec3 origin, vec3 direction) {
  vec3 finite = mix(direction, vec3(1e-20), lessThan(abs(direction), vec3(1e-20)));
  return Line(origin, direction, 1.0 / finite);
}

// Moeller and Trumbore 1997, about the origin of the line.
void meet(Line line, uint face, inout Hit hit) {
  uvec3 ids = TREE_BODY.faces.at[face];
  vec3 first = TREE_BODY.vertices.at[ids.x], a = first - line.origin;
  vec3 ab = TREE_BODY.vertices.at[ids.y] - first, ac = TREE_BODY.vertices.at[ids.z] - first;
  vec3 p = cross(line.direction, ac);
  float det = dot(ab, p);
  if (det == 0.0) return;
  float u = -dot(a, p) / det;
  vec3 q = cross(ab, a);
  float v = dot(line.direction, q) / det, distance = dot(ac, q) / det;
  if (u < -OVERLAP || v < -OVERLAP || u + v > 1.0 + OVERLAP || distance <= 0.0 || distance >= hit.distance) return;
  hit = Hit(distance, face, det > 0.0, vec2(u, v));
}

bool may_meet(Line line, Box box, float least) {
  vec3 a = (box.low - line.origin) * line.inverse, b = (box.high - line.origin) * line.inverse;
  vec3 near = min(a, b), far = max(a, b);
  float enter = max(max(near.x, near.y), max(near.z, 0.0));
  float leave = min(min(far.x, far.y), far.z) * 1.000001;  // beyond all rounding
  return enter <= min(leave, least);
}

// A face that a line meets, other than `own`, up to the distance `reach`: any, or the first.
Hit met(Line line, uint own, float reach, bool any_does) {
  Hit hit = Hit(reach, NO_FACE, false, vec2(0));
  uint node = 1u;
  while (node != 0u && !(any_does && hit.face != NO_FACE)) {
    if (may_meet(line, TREE.boxes.at[node], hit.distance)) {
      if (node < TREE.leaf_count) {
        node *= 2u;
        continue;
      }
      uint leaf = node - TREE.leaf_count;
      for (uint k = TREE.leaf_begin.at[leaf]; k < TREE.leaf_begin.at[leaf + 1u]; ++k) {
        uint face = TREE.order.at[k];
        if (face != own) meet(line, face, hit);
      }
    }
    // On to the next subtree to the right; a path of right turns alone was the last.
    while ((node & 1u) == 1u) node >>= 1u;
    if (node != 0u) ++node;
  }
  return hit;
}

Hit first_met(Line line, uint own, float reach) {
  return met(line, own, reach, false);
}

bool meets_any(Line line, uint own, float reach) {
  return met(line, own, reach, true).face != NO_FACE;
}

#endif
