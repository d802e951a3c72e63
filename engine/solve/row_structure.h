// What an operator's rows look like on one level before any value is known: columns in slices
// (shaders/solver/solve_shared.h, RowsRef), and which tets and faces contribute to which entry.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "engine/base/listener.h"
#include "engine/base/solve_options.h"
#include "engine/file/graph.h"

namespace quadgraph {

// Sliced columns, padded with the row's own index.
struct SlicedColumns {
  std::uint32_t slice_rows;
  std::vector<std::uint32_t> slice_offset;  // slices + 1
  std::vector<std::uint32_t> column;
};

// Neighbours of every row, in compressed rows, ascending.
struct Neighbours {
  std::vector<std::uint32_t> offset;
  std::vector<std::uint32_t> column;
};

// What the entries of fem rows are made of where the coefficients are the same everywhere (AssembleEvenPush).
struct FemShape {
  std::vector<glm::vec2> entry;  // stiffness, mm; mass, mm^3; 0 in padding
  std::vector<float> area;       // mm^2; of the slices that surface vertices have a part in
  std::vector<glm::vec2> row;    // mass, mm^3; area, mm^2
};

// The tets at every vertex.
struct TetIncidence {
  std::vector<std::uint32_t> offset;  // vertices + 1
  std::vector<std::uint32_t> tet;
};

// Which elements make the entries of fem rows (AssembleEdgesPush).
struct FemRings {
  std::vector<glm::uvec2> edge_entry;  // the two entries of every edge
  std::vector<std::uint32_t> ring_offset, ring;
};

// The open outside faces at every surface vertex.
struct FaceIncidence {
  std::vector<std::uint32_t> offset;  // surface vertices + 1
  std::vector<std::uint32_t> face;
};

// Rows of the vertices of a polygrid: the six links, in their order, or the one.
SlicedColumns grid_columns(const Level& level, std::uint32_t slice_rows);

// Rows of the nodes: the four links, or the one.
SlicedColumns node_columns(const Level& level, std::uint32_t slice_rows);

// The vertices around every vertex, ascending.
Neighbours vertex_neighbours(const Level& level, const Listener& listener = {});

// Rows of the vertices.
SlicedColumns slice(const Neighbours& rows, std::uint32_t slice_rows);

// What elements make of the present vertices of `level`; `rows` are its vertex_neighbours.
FemShape fem_shape(const Level& level, const Neighbours& rows, const SlicedColumns& columns,
                   const Listener& listener = {});
FemRings fem_rings(const Level& level, const Neighbours& rows, const SlicedColumns& columns,
                   const Listener& listener = {});

FaceIncidence face_incidence(const Level& level);
TetIncidence tet_incidence(const Level& level, const Listener& listener = {});

}  // namespace quadgraph
