#include "engine/solve/row_structure.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string>

#include "engine/graph/error.h"
#include "shaders/solve_shared.h"

namespace quadgraph {
namespace {

constexpr std::uint32_t max_neighbours = 1024;  // a place has 10 bits

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

// (tet * 4 + corner, 0) at every vertex.
Incidence tets_at_vertices(const Level& level) {
  Incidence at;
  at.offset.assign(level.vertices.size() + 1, 0);
  at.element.resize(4 * level.tets.size());
  for (const glm::uvec4& tet : level.tets) {
    for (int k = 0; k < 4; ++k) ++at.offset[tet[k] + 1];
  }
  for (std::size_t v = 0; v < level.vertices.size(); ++v) at.offset[v + 1] += at.offset[v];
  std::vector<std::uint32_t> next(at.offset.begin(), at.offset.end() - 1);
  for (std::uint32_t t = 0; t < level.tet_count(); ++t) {
    for (std::uint32_t k = 0; k < 4; ++k) at.element[next[level.tets[t][static_cast<int>(k)]]++] = {4 * t + k, 0};
  }
  return at;
}

Neighbours vertex_neighbours(const Level& level, const Incidence& tets) {
  Neighbours rows;
  rows.offset.push_back(0);
  std::vector<std::uint32_t> seen(level.vertices.size(), std::numeric_limits<std::uint32_t>::max());
  for (std::uint32_t v = 0; v < level.vertex_count(); ++v) {
    seen[v] = v;
    for (std::uint32_t i = tets.offset[v]; i < tets.offset[v + 1]; ++i) {
      const glm::uvec4& tet = level.tets[tets.element[i].x / 4];
      for (int k = 0; k < 4; ++k) {
        if (seen[tet[k]] == v) continue;
        seen[tet[k]] = v;
        rows.column.push_back(tet[k]);
      }
    }
    std::sort(rows.column.begin() + rows.offset.back(), rows.column.end());
    rows.offset.push_back(static_cast<std::uint32_t>(rows.column.size()));
    const std::uint32_t count = rows.offset[v + 1] - rows.offset[v];
    if (count > max_neighbours) {
      throw InputError("vertex " + std::to_string(v) + " has " + std::to_string(count) + " neighbours, at most " +
                       std::to_string(max_neighbours) + " are allowed");
    }
  }
  return rows;
}

// Place of `column` in row `row`, which holds it.
std::uint32_t place_of(const SlicedColumns& sliced, std::uint32_t row, std::uint32_t column) {
  std::uint32_t entry = sliced.slice_offset[row / SLICE_ROWS] + row % SLICE_ROWS;
  std::uint32_t place = 0;
  while (sliced.column[entry + place * SLICE_ROWS] != column) ++place;
  return place;
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
  FemStructure structure;
  structure.tets = tets_at_vertices(level);
  const Neighbours rows = vertex_neighbours(level, structure.tets);
  structure.columns = slice(rows);
  std::vector<std::uint32_t> place(level.vertices.size());
  for (std::uint32_t v = 0; v < level.vertex_count(); ++v) {
    for (std::uint32_t e = rows.offset[v]; e < rows.offset[v + 1]; ++e) place[rows.column[e]] = e - rows.offset[v];
    for (std::uint32_t i = structure.tets.offset[v]; i < structure.tets.offset[v + 1]; ++i) {
      glm::uvec2& element = structure.tets.element[i];
      const glm::uvec4& tet = level.tets[element.x / 4];
      std::uint32_t shift = 0;
      for (std::uint32_t k = 0; k < 4; ++k) {
        if (k == element.x % 4) continue;
        element.y |= place[tet[static_cast<int>(k)]] << shift;
        shift += 10;
      }
    }
  }
  return structure;
}

Incidence face_incidence(const Level& level, const SlicedColumns* columns) {
  Incidence at;
  at.offset.assign(level.surface_vertex_count + 1, 0);
  at.element.resize(3 * level.faces.size());
  for (const glm::uvec3& face : level.faces) {
    for (int k = 0; k < 3; ++k) ++at.offset[face[k] + 1];
  }
  for (std::size_t v = 0; v < level.surface_vertex_count; ++v) at.offset[v + 1] += at.offset[v];
  std::vector<std::uint32_t> next(at.offset.begin(), at.offset.end() - 1);
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    const glm::uvec3& face = level.faces[f];
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t row = face[k];
      std::uint32_t places = 0;
      if (columns != nullptr) {
        places = place_of(*columns, row, face[(k + 1) % 3]) | place_of(*columns, row, face[(k + 2) % 3]) << 10;
      }
      at.element[next[row]++] = {f, places};
    }
  }
  return at;
}

}  // namespace quadgraph
