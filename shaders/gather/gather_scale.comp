#version 460
#extension GL_GOOGLE_include_directive : require
#include "gather/gather_shared.h"

layout(local_size_x = WORKGROUP_SIZE) in;

// Scale at surface vertices.
struct GatherScalePush {
  SolidRefs solid;  // one
  Uints face_offset;
  Uints face_incidence;
  Vec3s gathered;
  Vec3s exitance;  // W/mm^2 per surface vertex
  GatherNodes nodes;
  GatherScales scale;
  uint count;
};
layout(push_constant, scalar) uniform Block { GatherScalePush push; };

SolidRef solid;

// Where the means are taken.
struct Around {
  vec3 place, normal;  // mm, unit
  vec3 variance;       // mm^2 per channel
  vec3 gathered;       // W/mm^2
  vec3 edge;           // optical length of the mean edge
};

Around around_vertex(uint v) {
  vec3 normal = vec3(0), extinction = vec3(0), gathered = vec3(0);
  float size = 0.0, edges = 0.0;
  for (uint k = push.face_offset.at[v]; k < push.face_offset.at[v + 1u]; ++k) {
    uint face = push.face_incidence.at[k];
    uvec3 ids = solid.body.faces.at[face];
    vec3 a = solid.body.vertices.at[ids.x];
    vec3 ab = solid.body.vertices.at[ids.y] - a, ac = solid.body.vertices.at[ids.z] - a;
    vec3 doubled = cross(ab, ac), bc = ac - ab;
    float weight = length(doubled);
    uint tet = (solid.body.flags & BODY_EVEN) != 0u ? 0u : solid.body.face_tets.at[face];
    Optical optical = solid.body.optical.at[tet];
    normal += doubled;
    gathered += weight * push.gathered.at[face];
    size += weight;
    extinction += weight * (optical.sigma_s_prime + optical.sigma_a);
    edges += weight * (dot(ab, ab) + dot(ac, ac) + dot(bc, bc)) / 3.0;
  }
  size = max(size, 1e-30);
  vec3 path = 1.0 / max(extinction / size, vec3(1e-6));
  return Around(solid.body.vertices.at[v], normal / max(length(normal), 1e-30),
                GATHER_PATH * path * path + GATHER_EDGE * edges / size, gathered / size,
                sqrt(edges / size) / path);
}

struct Means {
  vec3 exitance, gathered, weight;
};

float squared(vec3 a) {
  return dot(a, a);
}

void add(inout Means means, GatherNode node, Around around) {
  if (node.area == 0.0) return;
  float distance_squared = squared(node.place / node.area - around.place);
  float facing = 0.5 * max(1.0 + dot(around.normal, node.normal) / node.area, 0.0);
  vec3 there = node.gathered / node.area;
  vec3 alike = min(there, around.gathered) / max(max(there, around.gathered), vec3(1e-37));
  alike = max(alike, vec3(GATHER_ALIKE));
  vec3 near = max(exp(-0.5 * distance_squared / around.variance) - exp(-0.5 * GATHER_REACH * GATHER_REACH), vec3(0));
  vec3 weight = facing * alike * near;
  means.exitance += weight * node.exitance;
  means.gathered += weight * node.gathered;
  means.weight += weight * node.area;
}

void add_leaf(inout Means means, uint leaf, Around around) {
  for (uint k = solid.tree.leaf_begin.at[leaf]; k < solid.tree.leaf_begin.at[leaf + 1u]; ++k) {
    add(means, push.nodes.at[2u * solid.tree.leaf_count + k], around);
  }
}

// The tree is walked as in face_tree.glsl.
Means means_around(Around around) {
  Means means = Means(vec3(0), vec3(0), vec3(0));
  uint node = 1u;
  while (node != 0u) {
    Box box = solid.tree.boxes.at[node];
    vec3 outside = max(max(box.low - around.place, around.place - box.high), vec3(0));
    bvec3 near = lessThanEqual(vec3(squared(outside)), GATHER_REACH * GATHER_REACH * around.variance);
    if (any(near)) {
      vec3 wanted = mix(vec3(1e37), around.variance, near);
      float finest = GATHER_NODE * GATHER_NODE * min(wanted.x, min(wanted.y, wanted.z));
      if (squared(box.high - box.low) <= finest) {
        add(means, push.nodes.at[node], around);
      } else if (node < solid.tree.leaf_count) {
        node *= 2u;
        continue;
      } else {
        add_leaf(means, node - solid.tree.leaf_count, around);
      }
    }
    while ((node & 1u) == 1u) node >>= 1u;
    if (node != 0u) ++node;
  }
  return means;
}

// Per channel, of edges of that optical length.
vec3 gather_floor(vec3 edge) { return GATHER_FLOOR * clamp(2.0 * edge / GATHER_LONG - 1.0, vec3(0), vec3(1)); }

void main() {
  uint v = gl_GlobalInvocationID.x;
  if (v >= push.count) return;
  solid = push.solid.at[0];
  Around around = around_vertex(v);
  Means means = means_around(around);
  vec3 factor = mix(vec3(0), min(means.exitance / means.gathered, vec3(GATHER_FACTOR_MAX)),
                    greaterThan(means.gathered, vec3(0)));
  vec3 rest = max(means.exitance - factor * means.gathered, vec3(0)) / max(means.weight, vec3(1e-30));
  push.scale.at[v] = GatherScale(factor, rest, gather_floor(around.edge) * push.exitance.at[v]);
}
