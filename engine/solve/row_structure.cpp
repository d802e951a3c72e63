#include "engine/solve/row_structure.h"

#include <algorithm>
#include <array>
#include <utility>

#include "shaders/solve_shared.h"

namespace quadgraph {
namespace {

// Neighbours of every row, in compressed rows.
struct Neighbours {
  std::vector<std::uint32_t> offset;
  std::vector<std::uint32_t> column;
};

SlicedColumns slice(const Neighbours& rows) {
  const std::size_t count = rows.offset.size() - 1;
  SlicedColumns sliced;
  sliced.slice_offset.push_back(0);
  for (std::size_t first = 0; first < count; first += SLICE_ROWS) {
    const std::size_t last = std::min<std::size_t>(first + SLICE_ROWS, count);
    std::uint32_t width = 0;
    for (std::size_t i = first; i < last; ++i) width = std::max(width, rows.offset[i + 1] - rows.offset[i]);
    for (std::uint32_t k = 0; k < width; ++k) {
      for (std::size_t i = first; i < first + SLICE_ROWS; ++i) {
        const bool present = i < last && k < rows.offset[i + 1] - rows.offset[i];
        const auto own = static_cast<std::uint32_t>(std::min(i, last - 1));
        sliced.column.push_back(present ? rows.column[rows.offset[i] + k] : own);
      }
    }
    sliced.slice_offset.push_back(static_cast<std::uint32_t>(sliced.column.size()));
  }
  return sliced;
}

// Pairs of corners of a tet, in the order of TET_SHAPE.
constexpr std::array<std::array<int, 2>, 6> tet_edges = {{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

// Neighbours of every vertex, each once, ascending.
Neighbours vertex_neighbours(const Level& level) {
  std::vector<std::vector<std::uint32_t>> lists(level.vertices.size());
  for (const glm::uvec4& tet : level.tets) {
    for (const auto& [a, b] : tet_edges) {
      lists[tet[a]].push_back(tet[b]);
      lists[tet[b]].push_back(tet[a]);
    }
  }
  Neighbours rows;
  rows.offset.push_back(0);
  for (auto& list : lists) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    rows.column.insert(rows.column.end(), list.begin(), list.end());
    rows.offset.push_back(static_cast<std::uint32_t>(rows.column.size()));
  }
  return rows;
}

// The place of `column` in row `row`, which holds it.
std::uint32_t place_of(const Neighbours& rows, std::uint32_t row, std::uint32_t column) {
  const auto begin = rows.column.begin() + rows.offset[row], end = rows.column.begin() + rows.offset[row + 1];
  return static_cast<std::uint32_t>(std::lower_bound(begin, end, column) - begin);
}

// Calls add(entry, element) for both entries of every edge of every tet and open face.
template <typename Function>
void for_each_element(const Level& level, const Neighbours& rows, const SlicedColumns& sliced, const Function& add) {
  const auto at_edge = [&](std::uint32_t a, std::uint32_t b, std::uint32_t element) {
    for (const auto& [row, column] : {std::pair(a, b), std::pair(b, a)}) {
      add(sliced.slice_offset[row / SLICE_ROWS] + row % SLICE_ROWS + place_of(rows, row, column) * SLICE_ROWS, element);
    }
  };
  for (std::uint32_t t = 0; t < level.tet_count(); ++t) {
    for (std::uint32_t e = 0; e < tet_edges.size(); ++e) {
      at_edge(level.tets[t][tet_edges[e][0]], level.tets[t][tet_edges[e][1]], 8 * t + e);
    }
  }
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    if (level.reflecting(f)) continue;
    for (int k = 0; k < 3; ++k) at_edge(level.faces[f][k], level.faces[f][(k + 1) % 3], 8 * f + gpu::RING_FACE);
  }
}

}  // namespace

SlicedColumns node_columns(const Level& level) {
  Neighbours rows;
  rows.offset.push_back(0);
  for (const glm::uvec4& links : level.links) {
    for (int k = 0; k < 4; ++k) rows.column.push_back(links[k]);
    rows.offset.push_back(static_cast<std::uint32_t>(rows.column.size()));
  }
  for (const std::uint32_t tet : level.face_tets) {
    rows.column.push_back(tet);
    rows.offset.push_back(static_cast<std::uint32_t>(rows.column.size()));
  }
  return slice(rows);
}

FemStructure fem_structure(const Level& level) {
  const Neighbours rows = vertex_neighbours(level);
  FemStructure structure;
  structure.columns = slice(rows);
  std::vector<std::uint32_t>& offset = structure.ring_offset;
  offset.assign(structure.columns.column.size() + 1, 0);
  for_each_element(level, rows, structure.columns, [&](std::uint32_t entry, std::uint32_t) { ++offset[entry + 1]; });
  for (std::size_t e = 1; e < offset.size(); ++e) offset[e] += offset[e - 1];
  structure.ring.resize(offset.back());
  std::vector<std::uint32_t> next(offset.begin(), offset.end() - 1);
  for_each_element(level, rows, structure.columns,
                   [&](std::uint32_t entry, std::uint32_t element) { structure.ring[next[entry]++] = element; });
  return structure;
}

FaceIncidence face_incidence(const Level& level) {
  FaceIncidence at;
  at.offset.assign(level.surface_vertex_count + 1, 0);
  const auto for_each_corner = [&](const auto& visit) {
    for (std::uint32_t f = 0; f < level.face_count(); ++f) {
      for (int k = 0; k < 3 && !level.reflecting(f); ++k) visit(level.faces[f][k], f);
    }
  };
  for_each_corner([&](std::uint32_t v, std::uint32_t) { ++at.offset[v + 1]; });
  for (std::size_t v = 0; v < level.surface_vertex_count; ++v) at.offset[v + 1] += at.offset[v];
  at.face.resize(at.offset.back());
  std::vector<std::uint32_t> next(at.offset.begin(), at.offset.end() - 1);
  for_each_corner([&](std::uint32_t v, std::uint32_t f) { at.face[next[v]++] = f; });
  return at;
}

}  // namespace quadgraph
