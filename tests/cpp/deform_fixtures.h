// Cages and lists of deformers for tests.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "engine/graph/deformer.h"

namespace quadgraph {

inline glm::dvec3 sheared(const glm::dvec3& p) {
  return {1.1 * p.x + 0.2 * p.y, 0.9 * p.y - 0.3 * p.z + 1, p.z + 0.1 * p.x - 2};
}

// Around a box, at rest: its corners moved out, and a tip on one side.
inline Deformer bumpy_cage(const RestBox& box) {
  Deformer cage{.kind = DeformerKind::cage};
  for (int k = 0; k < 8; ++k) {
    cage.cage.emplace_back(k & 1 ? box.high.x + 1 : box.low.x - 1, k & 2 ? box.high.y + 1.5 : box.low.y - 1,
                           k & 4 ? box.high.z + 1 + 0.3 * (k & 1) : box.low.z - 1);
  }
  cage.cage.push_back(0.5 * (box.low + box.high) + glm::dvec3(0, 0, 4 + 0.5 * (box.high.z - box.low.z)));
  cage.triangles = {{0, 2, 3}, {0, 3, 1}, {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3}, {0, 4, 6},
                    {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {4, 5, 8}, {5, 7, 8}, {7, 6, 8}, {6, 4, 8}};
  cage.moved = cage.cage;
  return cage;
}

// One of every kind that needs no shapes, for a body in the box.
inline std::vector<Deformer> all_kinds(const RestBox& box) {
  Deformer lattice{.kind = DeformerKind::lattice, .size = {2, 3, 4}};
  for (int i = 0; i < 24; ++i) lattice.displacements.emplace_back(0.1 * (i % 5), -0.07 * (i % 3), 0.05 * (i % 7));
  Deformer cage = bumpy_cage(box);
  cage.moved[8].z += 2;
  cage.moved[1].x -= 1;
  return {{.kind = DeformerKind::twist, .axis = {0.2, 1, 0.1}, .begin = 0.1, .end = 0.9, .degrees = 140},
          {.kind = DeformerKind::bend, .axis = {0, 1, 0}, .towards = {1, 1, 1}, .degrees = -60},
          {.kind = DeformerKind::taper, .axis = {1, 0, 0}, .factor = 0.6},
          {.kind = DeformerKind::stretch, .axis = {0, 1, 1}, .factor = 1.4},
          lattice,
          cage,
          {.kind = DeformerKind::transform, .axis = {1, 2, 3}, .degrees = 77, .scale = {1, 1.5, 1}}};
}

}  // namespace quadgraph
