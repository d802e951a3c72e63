// What remains of an operator in a layout.
#include <algorithm>

#include "tools/layouts/factors.h"

namespace quadgraph::layouts {
namespace {

double most(const glm::dvec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

// The power of two that brings `largest` to 2^14 or a little more, so that nearly 2^30 is left for smaller values.
double into_half(double largest) {
  return largest > 0 ? std::exp2(14 - std::floor(std::log2(largest))) : 1.0;
}

Terms rounded(const Terms& terms, const Geometry& geometry, const Factors& factors) {
  return {.stiffness = terms.stiffness,
          .absorption = through_half(terms.absorption, glm::dvec3(factors.absorption)),
          .relaxation = through_half(terms.relaxation, glm::dvec3(factors.relaxation)),
          .boundary = glm::dvec3(through_half(geometry.b, factors.b))};
}

Geometry rounded(const Geometry& e, int entries, const Factors& factors) {
  if (entries == ENTRIES_GEOMETRY) return e;
  const double g = entries == ENTRIES_GEOMETRY_HALF ? through_half(e.g, factors.g) : e.g;
  return {.g = g, .m = through_half(e.m, factors.m), .b = through_half(e.b, factors.b)};
}

Block geometric(const Matrix& matrix, const Layout& layout, const Factors& factors, std::uint32_t i, std::uint32_t e) {
  const Geometry edge = rounded(matrix.geometry[e], layout.entries, factors);
  const bool edges = layout.coefficients == COEFFICIENTS_EDGE;
  const Coefficients& a = layout.coefficients_of(matrix)[edges ? i : 0];
  const Coefficients& b = layout.coefficients_of(matrix)[edges ? matrix.rows.column[e] : 0];
  return block_of({.stiffness = edge.g / 2 * (a.kappa + b.kappa),
                   .absorption = edge.m / 2 * (a.sigma_a + b.sigma_a),
                   .relaxation = edge.m / 2 * (a.relaxation + b.relaxation),
                   .boundary = glm::dvec3(edge.b)},
                  matrix.model, matrix.boundary);
}

Block weight_of(const Matrix& matrix, const Layout& layout, const Factors& factors, std::uint32_t i, std::uint32_t e) {
  if (layout.geometric()) return geometric(matrix, layout, factors, i, e);
  if (layout.entries == ENTRIES_STIFFNESS_HALF) {
    return block_of(rounded(matrix.terms[e], matrix.geometry[e], factors), matrix.model, matrix.boundary);
  }
  const Block& w = matrix.rows.weight[e];
  if (layout.entries != ENTRIES_HALF) return w;
  return {through_half(w.a11, factors.weight), through_half(w.a12, factors.weight),
          through_half(w.a22, factors.weight)};
}

}  // namespace

Factors factors_of(const Matrix& matrix, const Layout& layout) {
  Factors factors;
  const bool half_masses = layout.entries == ENTRIES_MIXED || layout.entries == ENTRIES_GEOMETRY_HALF;
  Geometry top;
  glm::dvec3 weight{0};
  double absorption = 0, relaxation = 0;
  for (std::size_t e = 0; e < matrix.entries(); ++e) {
    const Geometry& edge = matrix.geometry[e];
    top = {std::max(top.g, std::abs(edge.g)), std::max(top.m, edge.m), std::max(top.b, edge.b)};
    const Block& w = matrix.rows.weight[e];
    weight = glm::max(weight, glm::max(glm::abs(w.a11), glm::abs(w.a22)));
    absorption = std::max(absorption, most(matrix.terms[e].absorption));
    relaxation = std::max(relaxation, most(matrix.terms[e].relaxation));
  }
  if (layout.entries == ENTRIES_HALF) factors.weight = {into_half(weight.x), into_half(weight.y), into_half(weight.z)};
  if (layout.entries == ENTRIES_GEOMETRY_HALF) factors.g = into_half(top.g);
  if (half_masses) factors.m = into_half(top.m);
  if (half_masses || layout.entries == ENTRIES_STIFFNESS_HALF) factors.b = into_half(top.b);
  if (layout.entries == ENTRIES_STIFFNESS_HALF) {
    factors.absorption = into_half(absorption);
    factors.relaxation = into_half(relaxation);
  }
  return factors;
}

Rows represented(const Matrix& matrix, const Layout& layout) {
  const Factors factors = factors_of(matrix, layout);
  Rows rows =
      layout.coefficients == COEFFICIENTS_EDGE ? edge_averaged(matrix, layout.coefficients_of(matrix)) : matrix.rows;
  for (std::uint32_t i = 0; i < matrix.count(); ++i) {
    const Block sum = row_sum(rows, i);
    Block diagonal = sum;
    for (std::uint32_t e = rows.offset[i]; e < rows.offset[i + 1]; ++e) {
      rows.weight[e] = weight_of(matrix, layout, factors, i, e);
      diagonal.a11 -= rows.weight[e].a11;
      diagonal.a12 -= rows.weight[e].a12;
      diagonal.a22 -= rows.weight[e].a22;
    }
    rows.diagonal[i] = diagonal;
  }
  return rows;
}

}  // namespace quadgraph::layouts
