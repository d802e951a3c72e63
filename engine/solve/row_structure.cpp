#include "engine/solve/row_structure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "engine/file/geometry.h"
#include "engine/file/polygrid.h"
#include "shaders/assemble/assembly_shared.h"

namespace quadgraph {
namespace {

// Pairs of corners of a tet, in the order of TET_SHAPE.
constexpr std::array<std::array<int, 2>, 6> tet_edges = {{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

// The place of `column` in row `row`, which holds it.
std::uint32_t place_of(const Neighbours& rows, std::uint32_t row, std::uint32_t column) {
  const auto begin = rows.column.begin() + rows.offset[row], end = rows.column.begin() + rows.offset[row + 1];
  return static_cast<std::uint32_t>(std::lower_bound(begin, end, column) - begin);
}

std::uint32_t entry_of(const Neighbours& rows, const SlicedColumns& sliced, std::uint32_t row, std::uint32_t column) {
  const std::uint32_t side = sliced.slice_rows;
  return sliced.slice_offset[row / side] + row % side + place_of(rows, row, column) * side;
}

// Lists of elements, one after the other.
struct Lists {
  std::vector<std::uint32_t> offset, element;
};

// for_each(add) calls add(list, element) for everything, in order; twice.
template <typename ForEach>
Lists gather(std::size_t count, const Listener& listener, const ForEach& for_each) {
  Lists lists;
  lists.offset.assign(count + 1, 0);
  for_each([&](std::uint32_t list, std::uint32_t) { ++lists.offset[list + 1]; });
  for (std::size_t i = 0; i < count; ++i) {
    heed(listener, i);
    lists.offset[i + 1] += lists.offset[i];
  }
  lists.element.resize(lists.offset.back());
  heed(listener, 0);
  std::vector<std::uint32_t> next(lists.offset.begin(), lists.offset.end() - 1);
  for_each([&](std::uint32_t list, std::uint32_t element) { lists.element[next[list]++] = element; });
  return lists;
}

// Edges by their lower end, then by the other.
class Edges {
 public:
  Edges(const Neighbours& rows, const Listener& listener) : rows_(rows) {
    first_.push_back(0);
    for (std::uint32_t i = 0; i + 1 < rows.offset.size(); ++i) {
      heed(listener, i);
      below_.push_back(place_of(rows, i, i));
      first_.push_back(first_.back() + rows.offset[i + 1] - rows.offset[i] - below_.back());
    }
  }

  std::uint32_t count() const { return first_.back(); }

  std::uint32_t between(std::uint32_t a, std::uint32_t b) const {
    if (a > b) std::swap(a, b);
    return first_[a] + place_of(rows_, a, b) - below_[a];
  }

  // Calls visit(lower end, other end), in order.
  template <typename Function>
  void for_each(const Function& visit) const {
    for (std::uint32_t i = 0; i < below_.size(); ++i) {
      for (std::uint32_t k = rows_.offset[i] + below_[i]; k < rows_.offset[i + 1]; ++k) visit(i, rows_.column[k]);
    }
  }

 private:
  const Neighbours& rows_;
  std::vector<std::uint32_t> below_;  // neighbours before the vertex itself
  std::vector<std::uint32_t> first_;  // edge of every vertex, with the end
};

// The six edges of every tet, one tet after the other.
std::vector<std::uint32_t> edges_of_tets(const Level& level, const Edges& edges, const Listener& listener) {
  std::vector<std::uint32_t> found;
  found.reserve(tet_edges.size() * level.tets.size());
  for (const glm::uvec4& tet : level.tets) {
    heed(listener, found.size() / tet_edges.size());
    for (const auto& [a, b] : tet_edges) found.push_back(edges.between(tet[a], tet[b]));
  }
  return found;
}

// What lies around every edge: tets, then open faces.
Lists rings_of(const Level& level, const Edges& edges, const Listener& listener) {
  const std::vector<std::uint32_t> of_tets = edges_of_tets(level, edges, listener);
  return gather(edges.count(), listener, [&](const auto& add) {
    for (std::uint32_t t = 0; t < level.tet_count(); ++t) {
      heed(listener, t);
      for (std::uint32_t e = 0; e < tet_edges.size(); ++e) add(of_tets[tet_edges.size() * t + e], 8 * t + e);
    }
    for (std::uint32_t f = 0; f < level.face_count(); ++f) {
      for (int k = 0; k < 3 && !level.reflecting(f); ++k) {
        add(edges.between(level.faces[f][k], level.faces[f][(k + 1) % 3]), 8 * f + gpu::RING_FACE);
      }
    }
  });
}

// What an entry of linear elements is made of: integrals of the two basis functions over tets and open faces.
struct EdgeShape {
  double stiffness = 0;  // of the product of their gradients, mm
  double mass = 0;       // of their product, mm^3
  double area = 0;       // the same over faces, mm^2
};

void add_tets(const Level& level, const Edges& edges, const Listener& listener, std::vector<EdgeShape>& of_edge,
              std::vector<glm::vec2>& of_row) {
  std::vector<double> mass(of_row.size(), 0.0);
  for (std::uint32_t t = 0; t < level.tet_count(); ++t) {
    heed(listener, t);
    const glm::uvec4& tet = level.tets[t];
    const glm::dvec3 p(level.vertices[tet.x]);
    const glm::dvec3 e1 = glm::dvec3(level.vertices[tet.y]) - p, e2 = glm::dvec3(level.vertices[tet.z]) - p,
                     e3 = glm::dvec3(level.vertices[tet.w]) - p;
    // The gradient of corner k is normal[k] / (6 V), up to an orientation that cancels in products.
    const glm::dvec3 n1 = glm::cross(e2, e3), n2 = glm::cross(e3, e1), n3 = glm::cross(e1, e2);
    const std::array<glm::dvec3, 4> normal = {-(n1 + n2 + n3), n1, n2, n3};
    const double six_volume = std::abs(glm::dot(e1, n1));
    for (const auto& [a, b] : tet_edges) {
      EdgeShape& edge = of_edge[edges.between(tet[a], tet[b])];
      edge.stiffness +=
          glm::dot(normal[static_cast<std::size_t>(a)], normal[static_cast<std::size_t>(b)]) / (6 * six_volume);
      edge.mass += six_volume / 120;
    }
    for (int k = 0; k < 4; ++k) mass[tet[k]] += six_volume / 24;
  }
  for (std::size_t i = 0; i < mass.size(); ++i) of_row[i].x = static_cast<float>(mass[i]);
}

void add_faces(const Level& level, const Edges& edges, std::vector<EdgeShape>& of_edge,
               std::vector<glm::vec2>& of_row) {
  std::vector<double> area(level.surface_vertex_count, 0.0);
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    if (level.reflecting(f)) continue;
    const glm::uvec3& face = level.faces[f];
    const double twice_area = 2 * face_area(level, face);
    for (int k = 0; k < 3; ++k) {
      of_edge[edges.between(face[k], face[(k + 1) % 3])].area += twice_area / 24;
      area[face[k]] += twice_area / 6;
    }
  }
  for (std::size_t i = 0; i < area.size(); ++i) of_row[i].y = static_cast<float>(area[i]);
}

}  // namespace

Neighbours vertex_neighbours(const Level& level, const Listener& listener) {
  Lists around = gather(level.vertices.size(), listener, [&](const auto& add) {
    for (std::uint32_t t = 0; t < level.tet_count(); ++t) {
      heed(listener, t);
      const glm::uvec4& tet = level.tets[t];
      for (const auto& [a, b] : tet_edges) {
        add(tet[a], tet[b]);
        add(tet[b], tet[a]);
      }
    }
  });
  Neighbours rows;
  rows.offset.push_back(0);
  for (std::size_t v = 0; v + 1 < around.offset.size(); ++v) {
    heed(listener, v);
    const auto begin = around.element.begin() + around.offset[v], end = around.element.begin() + around.offset[v + 1];
    std::sort(begin, end);
    rows.column.insert(rows.column.end(), begin, std::unique(begin, end));
    rows.offset.push_back(static_cast<std::uint32_t>(rows.column.size()));
  }
  return rows;
}

SlicedColumns slice(const Neighbours& rows, std::uint32_t slice_rows) {
  const std::size_t count = rows.offset.size() - 1;
  SlicedColumns sliced{.slice_rows = slice_rows, .slice_offset = {}, .column = {}};
  sliced.slice_offset.push_back(0);
  for (std::size_t first = 0; first < count; first += slice_rows) {
    const std::size_t last = std::min<std::size_t>(first + slice_rows, count);
    std::uint32_t width = 0;
    for (std::size_t i = first; i < last; ++i) width = std::max(width, rows.offset[i + 1] - rows.offset[i]);
    for (std::uint32_t k = 0; k < width; ++k) {
      for (std::size_t i = first; i < first + slice_rows; ++i) {
        const bool present = i < last && k < rows.offset[i + 1] - rows.offset[i];
        const auto own = static_cast<std::uint32_t>(std::min(i, last - 1));
        sliced.column.push_back(present ? rows.column[rows.offset[i] + k] : own);
      }
    }
    sliced.slice_offset.push_back(static_cast<std::uint32_t>(sliced.column.size()));
  }
  return sliced;
}

SlicedColumns node_columns(const Level& level, std::uint32_t slice_rows) {
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
  return slice(rows, slice_rows);
}

SlicedColumns grid_columns(const Level& level, std::uint32_t slice_rows) {
  Neighbours rows;
  rows.offset.push_back(0);
  for (const std::uint32_t neighbour : grid_neighbours(level)) {
    rows.column.push_back(neighbour);
    rows.offset.push_back(static_cast<std::uint32_t>(rows.column.size()));
  }
  rows.column.insert(rows.column.end(), level.grid_links.begin(), level.grid_links.end());
  while (rows.offset.size() <= level.vertices.size()) rows.offset.push_back(rows.offset.back() + grid_link_count);
  return slice(rows, slice_rows);
}

FemShape fem_shape(const Level& level, const Neighbours& rows, const SlicedColumns& columns, const Listener& listener) {
  const Edges edges(rows, listener);
  std::vector<EdgeShape> of_edge(edges.count());
  FemShape shape;
  shape.row.assign(level.vertices.size(), glm::vec2(0));
  add_tets(level, edges, listener, of_edge, shape.row);
  add_faces(level, edges, of_edge, shape.row);
  shape.entry.assign(columns.column.size(), glm::vec2(0));
  const std::uint32_t surface_slices = (level.surface_vertex_count + columns.slice_rows - 1) / columns.slice_rows;
  shape.area.assign(columns.slice_offset[surface_slices], 0.0f);
  std::uint32_t edge = 0;
  edges.for_each([&](std::uint32_t a, std::uint32_t b) {
    heed(listener, edge);
    const EdgeShape& own = of_edge[edge++];
    for (const std::uint32_t entry : {entry_of(rows, columns, a, b), entry_of(rows, columns, b, a)}) {
      shape.entry[entry] = glm::vec2(own.stiffness, own.mass);
      if (own.area > 0) shape.area[entry] = static_cast<float>(own.area);
    }
  });
  return shape;
}

FemRings fem_rings(const Level& level, const Neighbours& rows, const SlicedColumns& columns, const Listener& listener) {
  const Edges edges(rows, listener);
  FemRings structure;
  structure.edge_entry.reserve(edges.count());
  edges.for_each([&](std::uint32_t a, std::uint32_t b) {
    heed(listener, structure.edge_entry.size());
    structure.edge_entry.emplace_back(entry_of(rows, columns, a, b), entry_of(rows, columns, b, a));
  });
  Lists rings = rings_of(level, edges, listener);
  structure.ring_offset = std::move(rings.offset);
  structure.ring = std::move(rings.element);
  return structure;
}

TetIncidence tet_incidence(const Level& level, const Listener& listener) {
  Lists tets = gather(level.vertices.size(), listener, [&](const auto& add) {
    for (std::uint32_t t = 0; t < level.tet_count(); ++t) {
      heed(listener, t);
      for (int k = 0; k < 4; ++k) add(level.tets[t][k], t);
    }
  });
  return {std::move(tets.offset), std::move(tets.element)};
}

FaceIncidence face_incidence(const Level& level) {
  Lists faces = gather(level.surface_vertex_count, {}, [&](const auto& add) {
    for (std::uint32_t f = 0; f < level.face_count(); ++f) {
      for (int k = 0; k < 3 && !level.reflecting(f); ++k) add(level.faces[f][k], f);
    }
  });
  return {std::move(faces.offset), std::move(faces.element)};
}

}  // namespace quadgraph
