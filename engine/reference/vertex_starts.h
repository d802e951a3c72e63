// Where rays that start at the vertices of a level begin; what the gather (engine/reference/radiance.h and the GPU)
// needs of the shape alone.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "engine/base/listener.h"
#include "engine/file/graph.h"

namespace quadgraph {

// One entry per vertex.
struct VertexStarts {
  // The surface vertex that stands for the way out: itself at a vertex of an open face; else found by spreading over
  // the edges of the tets, smallest distance first. A level without open faces: itself.
  std::vector<std::uint32_t> nearest;
  // A tet at the vertex: the one that the outward normal at `nearest` points into, or, where it points into none (at
  // most surface vertices), the one that it misses least.
  std::vector<std::uint32_t> start;
};

VertexStarts vertex_starts(const Level& level, const Listener& listener = {});

// As VertexStarts::nearest, of the open faces and of those that two bodies share; empty where no two share any.
std::vector<std::uint32_t> nearest_boundary(const Level& level, const Listener& listener = {});

// Unit outward normals, the area-weighted means of the open faces around; 0 at vertices without.
std::vector<glm::dvec3> open_normals(const Level& level);

}  // namespace quadgraph
