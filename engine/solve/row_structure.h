// What an operator's rows look like on one level before any value is known: columns in slices (shaders/solve_shared.h,
// RowsRef), and which tets and faces contribute to which entry.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "engine/graph/graph.h"
#include "engine/graph/solution.h"

namespace quadgraph {

// Sliced columns, padded with the row's own index.
struct SlicedColumns {
  std::vector<std::uint32_t> slice_offset;  // slices + 1
  std::vector<std::uint32_t> column;
};

// Columns of fem rows, and which elements make their entries (AssembleEdgesPush, AssembleFemPush).
struct FemStructure {
  SlicedColumns columns;
  std::vector<glm::uvec2> edge_entry;  // the two entries of every edge
  std::vector<std::uint32_t> ring_offset, ring;
  std::vector<std::uint32_t> tet_offset, tet_incidence;
};

// The open outside faces at every surface vertex.
struct FaceIncidence {
  std::vector<std::uint32_t> offset;  // surface vertices + 1
  std::vector<std::uint32_t> face;
};

// Rows of the nodes: the four links, or the one.
SlicedColumns node_columns(const Level& level);

// Rows of the vertices: their neighbours, ascending.
FemStructure fem_structure(const Level& level);

FaceIncidence face_incidence(const Level& level);

}  // namespace quadgraph
