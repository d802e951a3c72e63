// What an operator's rows look like on one level before any value is known: columns in slices (shaders/solve_shared.h,
// RowsRef), and which tets and faces contribute to which row.
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

// For every row, (element, places) as in AssembleFemPush.
struct Incidence {
  std::vector<std::uint32_t> offset;  // rows + 1
  std::vector<glm::uvec2> element;
};

struct FemStructure {
  SlicedColumns columns;
  Incidence tets;
};

// Rows of the nodes: the four links, or the one.
SlicedColumns node_columns(const Level& level);

// Rows of the vertices: their neighbours, ascending. Throws InputError if a vertex has more than 1024.
FemStructure fem_structure(const Level& level);

// The faces at every surface vertex, with places in the rows of `columns`; places are 0 without columns.
Incidence face_incidence(const Level& level, const SlicedColumns* columns);

}  // namespace quadgraph
