// fem: linear elements on the tet vertices, consistent mass, Robin mass on the outside faces.
#include <algorithm>
#include <cmath>

#include "engine/file/geometry.h"
#include "engine/reference/discretisation.h"
#include "engine/reference/elements.h"
#include "shaders/material/optics.h"

namespace quadgraph {
namespace {

struct TetGeometry {
  std::array<glm::dvec3, 4> gradient;  // 1/mm, of each vertex's basis function
  double volume;                       // mm^3
};

TetGeometry tet_geometry(const Level& level, const glm::uvec4& tet) {
  const glm::dvec3 p(level.vertices[tet[0]]);
  const glm::dvec3 e1 = glm::dvec3(level.vertices[tet[1]]) - p;
  const glm::dvec3 e2 = glm::dvec3(level.vertices[tet[2]]) - p;
  const glm::dvec3 e3 = glm::dvec3(level.vertices[tet[3]]) - p;
  const double determinant = glm::dot(e1, glm::cross(e2, e3));
  TetGeometry g;
  g.gradient[1] = glm::cross(e2, e3) / determinant;
  g.gradient[2] = glm::cross(e3, e1) / determinant;
  g.gradient[3] = glm::cross(e1, e2) / determinant;
  g.gradient[0] = -(g.gradient[1] + g.gradient[2] + g.gradient[3]);
  g.volume = determinant / 6.0;
  return g;
}

// Columns of every row, ascending, without the diagonal.
void build_pattern(const Level& level, Rows& rows) {
  const std::uint32_t n = level.vertex_count();
  std::vector<std::vector<std::uint32_t>> neighbours(n);
  for (const glm::uvec4& tet : level.tets) {
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        if (i != j) neighbours[tet[i]].push_back(tet[j]);
      }
    }
  }
  rows.offset.push_back(0);
  for (auto& list : neighbours) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    rows.column.insert(rows.column.end(), list.begin(), list.end());
    rows.offset.push_back(static_cast<std::uint32_t>(rows.column.size()));
  }
}

// The weight at (row, column), which the pattern holds.
Block& entry(Rows& rows, std::uint32_t row, std::uint32_t column) {
  const auto begin = rows.column.begin() + rows.offset[row];
  const auto end = rows.column.begin() + rows.offset[row + 1];
  return rows.weight[static_cast<std::size_t>(std::lower_bound(begin, end, column) - rows.column.begin())];
}

// Stiffness and consistent masses of one tet. The diagonal stiffness is minus the sum of the off-diagonals, so that
// constants are reproduced to rounding.
void add_tet(const TetGeometry& g, const glm::uvec4& tet, const ElementCoefficients& element, Model model, Rows& rows) {
  const Boundary none;
  const glm::dvec3 absorption = element.absorption * (g.volume / 20.0);
  const glm::dvec3 relaxation = element.relaxation * (g.volume / 20.0);
  for (int i = 0; i < 4; ++i) {
    Terms own{.absorption = 2.0 * absorption, .relaxation = 2.0 * relaxation};
    for (int j = 0; j < 4; ++j) {
      if (i == j) continue;
      const Terms terms{.stiffness = element.kappa * (glm::dot(g.gradient[i], g.gradient[j]) * g.volume),
                        .absorption = absorption,
                        .relaxation = relaxation};
      entry(rows, tet[i], tet[j]) += block_of(terms, model, none);
      own.stiffness -= terms.stiffness;
    }
    rows.diagonal[tet[i]] += block_of(own, model, none);
  }
}

void add_face(const Level& level, const glm::uvec3& face, Model model, const Boundary& boundary, Rows& rows) {
  const Block mass = block_of({.boundary = glm::dvec3(face_area(level, face) / 12.0)}, model, boundary);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (i != j) entry(rows, face[i], face[j]) += mass;
    }
    rows.diagonal[face[i]] += mass;
    rows.diagonal[face[i]] += mass;
  }
}

}  // namespace

Rows assemble_elements(const Level& level, std::span<const ElementCoefficients> elements, Model model,
                       const Boundaries& boundaries) {
  Rows rows;
  build_pattern(level, rows);
  rows.weight.assign(rows.column.size(), Block{});
  rows.diagonal.assign(level.vertices.size(), Block{});
  rows.to_phi.assign(level.vertices.size(), glm::dvec3(1));
  for (std::uint32_t t = 0; t < level.tet_count(); ++t) {
    add_tet(tet_geometry(level, level.tets[t]), level.tets[t], elements[t], model, rows);
  }
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    if (!level.reflecting(f)) add_face(level, level.faces[f], model, boundaries.behind(level, f), rows);
  }
  return rows;
}

ElementCoefficients element_of(const gpu::Optical& optical) {
  return {glm::dvec3(gpu::kappa(optical)), glm::dvec3(optical.sigma_a), relaxation_of(optical)};
}

void add_element_product(const Level& level, const glm::uvec4& tet, const ElementCoefficients& element,
                         std::span<const glm::vec3> field, std::span<glm::dvec3> sum) {
  const TetGeometry g = tet_geometry(level, tet);
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      const double slope = glm::dot(g.gradient[i], g.gradient[j]) * g.volume,
                   mass = (i == j ? 2.0 : 1.0) * g.volume / 20.0;
      sum[tet[i]] += (slope * element.kappa + mass * element.absorption) * glm::dvec3(field[tet[j]]);
    }
  }
}

Rows assemble_fem(const Level& level, const Problem& problem) {
  std::vector<ElementCoefficients> elements;
  for (std::uint32_t t = 0; t < level.tet_count(); ++t) elements.push_back(element_of(problem.optical[t]));
  return assemble_elements(level, elements, problem.model, problem.boundaries());
}

std::vector<ElementCoefficients> element_products(const Level& level, std::span<const Field> left,
                                                  std::span<const Field> right, Model model) {
  const Boundary none;
  const Block stiffness = block_of({.stiffness = glm::dvec3(1)}, model, none);
  const Block absorption = block_of({.absorption = glm::dvec3(1)}, model, none);
  const Block relaxation = block_of({.relaxation = glm::dvec3(1)}, model, none);
  std::vector<ElementCoefficients> products(level.tets.size());
  for (std::size_t t = 0; t < products.size(); ++t) {
    const TetGeometry g = tet_geometry(level, level.tets[t]);
    for (int i = 0; i < 4; ++i) {
      Field slope, mass;  // rows of what the elements make of `right`
      for (int j = 0; j < 4; ++j) {
        const Field& x = right[level.tets[t][j]];
        slope = slope + glm::dvec3(glm::dot(g.gradient[i], g.gradient[j]) * g.volume) * x;
        mass = mass + glm::dvec3((i == j ? 2.0 : 1.0) * g.volume / 20.0) * x;
      }
      const Field& y = left[level.tets[t][i]];
      products[t].kappa += dot(y, stiffness * slope);
      products[t].absorption += dot(y, absorption * mass);
      products[t].relaxation += dot(y, relaxation * mass);
    }
  }
  return products;
}

std::vector<glm::dvec3> surface_load_fem(const Level& level, std::span<const glm::vec3> q) {
  std::vector<glm::dvec3> load(level.vertices.size(), glm::dvec3(0));
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    if (level.reflecting(f)) continue;
    const glm::dvec3 share = glm::dvec3(q[f]) * (face_area(level, level.faces[f]) / 3.0);
    for (int i = 0; i < 3; ++i) load[level.faces[f][i]] += share;
  }
  return load;
}

}  // namespace quadgraph
