#include "tools/layouts/matrix.h"

#include <algorithm>
#include <array>
#include <utility>

#include "engine/file/geometry.h"
#include "engine/reference/discretisation.h"
#include "shaders/material/optics.h"

namespace quadgraph::layouts {
namespace {

std::size_t place(const Rows& rows, std::uint32_t row, std::uint32_t column) {
  const auto begin = rows.column.begin() + rows.offset[row];
  const auto end = rows.column.begin() + rows.offset[row + 1];
  return static_cast<std::size_t>(std::lower_bound(begin, end, column) - rows.column.begin());
}

// gradient_i . gradient_j volume of a tet, mm.
std::array<std::array<double, 4>, 4> stiffness(const Level& level, const glm::uvec4& tet, double volume) {
  std::array<glm::dvec3, 4> p, normal;
  for (int k = 0; k < 4; ++k) p[k] = glm::dvec3(level.vertices[tet[k]]);
  normal[1] = glm::cross(p[2] - p[0], p[3] - p[0]);
  normal[2] = glm::cross(p[3] - p[0], p[1] - p[0]);
  normal[3] = glm::cross(p[1] - p[0], p[2] - p[0]);
  normal[0] = -(normal[1] + normal[2] + normal[3]);
  std::array<std::array<double, 4>, 4> result{};
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) result[i][j] = glm::dot(normal[i], normal[j]) / (36.0 * volume);
  }
  return result;
}

Coefficients coefficients_of(const gpu::Optical& optical) {
  return {glm::dvec3(gpu::kappa(optical)), glm::dvec3(optical.sigma_a), relaxation_of(optical)};
}

void add(Coefficients& sum, double factor, const Coefficients& c) {
  sum = {sum.kappa + factor * c.kappa, sum.sigma_a + factor * c.sigma_a, sum.relaxation + factor * c.relaxation};
}

void add_tet(const Level& level, std::uint32_t t, const gpu::Optical& optical, Matrix& matrix) {
  const glm::uvec4& tet = level.tets[t];
  const double volume = tet_volume(level, tet);
  const auto g = stiffness(level, tet, volume);
  const Coefficients here = coefficients_of(optical);
  for (int i = 0; i < 4; ++i) {
    matrix.own[tet[i]].g += g[i][i];
    matrix.own[tet[i]].m += volume / 10.0;
    add(matrix.tet_means[tet[i]], volume, here);
    for (int j = 0; j < 4; ++j) {
      if (i == j) continue;
      const std::size_t e = place(matrix.rows, tet[i], tet[j]);
      matrix.geometry[e].g += g[i][j];
      matrix.geometry[e].m += volume / 20.0;
      matrix.terms[e].stiffness += g[i][j] * here.kappa;
      matrix.terms[e].absorption += volume / 20.0 * here.sigma_a;
      matrix.terms[e].relaxation += volume / 20.0 * here.relaxation;
    }
  }
}

void add_face(const Level& level, const glm::uvec3& face, Matrix& matrix) {
  const double share = face_area(level, face) / 12.0;
  for (int i = 0; i < 3; ++i) {
    matrix.own[face[i]].b += 2.0 * share;
    for (int j = 0; j < 3; ++j) {
      if (i == j) continue;
      const std::size_t e = place(matrix.rows, face[i], face[j]);
      matrix.geometry[e].b += share;
      matrix.terms[e].boundary += share;
    }
  }
}

bool all_equal(std::span<const gpu::Optical> optical) {
  return std::all_of(optical.begin(), optical.end(), [&](const gpu::Optical& o) {
    return o.sigma_a == optical[0].sigma_a && o.sigma_s_prime == optical[0].sigma_s_prime;
  });
}

void append_body(const Matrix& matrix, std::uint32_t padding, Matrix& result) {
  const auto first_row = static_cast<std::uint32_t>(result.rows.size());
  const auto first_entry = static_cast<std::uint32_t>(result.entries());
  for (std::uint32_t i = 0; i < matrix.count(); ++i) {
    result.rows.offset.push_back(first_entry + matrix.rows.offset[i + 1]);
  }
  for (std::uint32_t column : matrix.rows.column) result.rows.column.push_back(first_row + column);
  const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  append(result.rows.weight, matrix.rows.weight);
  append(result.rows.diagonal, matrix.rows.diagonal);
  append(result.terms, matrix.terms);
  append(result.geometry, matrix.geometry);
  append(result.own, matrix.own);
  append(result.tet_means, matrix.tet_means);
  append(result.at_vertices, matrix.at_vertices);
  const Terms identity{.stiffness = {}, .absorption = glm::dvec3(1), .relaxation = glm::dvec3(1), .boundary = {}};
  for (std::uint32_t k = 0; k < padding; ++k) {
    result.rows.offset.push_back(result.rows.offset.back());
    result.rows.diagonal.push_back(block_of(identity, matrix.model, matrix.boundary));
    result.own.push_back({.g = 0, .m = 1, .b = 0});
    result.tet_means.push_back({glm::dvec3(1), glm::dvec3(1), glm::dvec3(1)});
    result.at_vertices.push_back(result.tet_means.back());
  }
}

}  // namespace

Matrix matrix_of(const Level& level, const Problem& problem, std::span<const gpu::Optical> at_vertices) {
  Matrix matrix{.model = problem.model,
                .boundary = problem.boundaries().of(0),
                .even = all_equal(problem.optical),
                .rows = assemble(level, problem),
                .terms = {},
                .geometry = {},
                .own = {},
                .tet_means = {},
                .at_vertices = {}};
  matrix.terms.resize(matrix.entries());
  matrix.geometry.resize(matrix.entries());
  matrix.own.resize(matrix.count());
  matrix.tet_means.resize(matrix.count());
  for (const gpu::Optical& optical : at_vertices) matrix.at_vertices.push_back(coefficients_of(optical));
  for (std::uint32_t t = 0; t < level.tet_count(); ++t) add_tet(level, t, problem.optical[t], matrix);
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    if (!level.reflecting(f)) add_face(level, level.faces[f], matrix);
  }
  for (std::uint32_t i = 0; i < matrix.count(); ++i) {
    const Coefficients sum = std::exchange(matrix.tet_means[i], {});
    add(matrix.tet_means[i], 1 / (10.0 * matrix.own[i].m), sum);
  }
  return matrix;
}

Rows edge_averaged(const Matrix& matrix, std::span<const Coefficients> coefficients) {
  Rows rows = matrix.rows;
  for (std::uint32_t i = 0; i < matrix.count(); ++i) {
    const Coefficients& a = coefficients[i];
    Terms own{.stiffness = {},
              .absorption = matrix.own[i].m * a.sigma_a,
              .relaxation = matrix.own[i].m * a.relaxation,
              .boundary = glm::dvec3(matrix.own[i].b)};
    for (std::uint32_t e = rows.offset[i]; e < rows.offset[i + 1]; ++e) {
      const Coefficients& b = coefficients[rows.column[e]];
      const Geometry& edge = matrix.geometry[e];
      const Terms terms{.stiffness = edge.g / 2 * (a.kappa + b.kappa),
                        .absorption = edge.m / 2 * (a.sigma_a + b.sigma_a),
                        .relaxation = edge.m / 2 * (a.relaxation + b.relaxation),
                        .boundary = glm::dvec3(edge.b)};
      rows.weight[e] = block_of(terms, matrix.model, matrix.boundary);
      own.stiffness -= terms.stiffness;
    }
    rows.diagonal[i] = block_of(own, matrix.model, matrix.boundary);
  }
  return rows;
}

Block row_sum(const Rows& rows, std::uint32_t i) {
  Block sum = rows.diagonal[i];
  for (std::uint32_t e = rows.offset[i]; e < rows.offset[i + 1]; ++e) sum += rows.weight[e];
  return sum;
}

Matrix repeated(const Matrix& matrix, std::uint32_t copies) {
  if (copies <= 1) return matrix;
  constexpr std::uint32_t whole = 1024;  // rows, a multiple of every slice and window
  Matrix result;
  result.model = matrix.model;
  result.boundary = matrix.boundary;
  result.even = matrix.even;
  result.rows.offset.push_back(0);
  const std::uint32_t padding = (whole - matrix.count() % whole) % whole;
  for (std::uint32_t k = 0; k < copies; ++k) append_body(matrix, padding, result);
  return result;
}

}  // namespace quadgraph::layouts
