// The fem operator of a level in double precision, taken apart into what the layouts store.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/reference/operator.h"

namespace quadgraph::layouts {

// What a pair of vertices, or one vertex, gives the operator before the material is known.
struct Geometry {
  double g = 0;  // mm, integral of the product of the gradients
  double m = 0;  // mm^3, of the basis functions
  double b = 0;  // mm^2, of the basis functions over the open surface
};

// Coefficients at a vertex.
struct Coefficients {
  glm::dvec3 kappa{0};       // mm
  glm::dvec3 sigma_a{0};     // 1/mm
  glm::dvec3 relaxation{0};  // 1/mm, 5/9 sigma_t
};

struct Matrix {
  Model model = Model::diffusion;
  Boundary boundary;
  bool even = false;                      // the same coefficients everywhere
  Rows rows;                              // as the engine assembles them
  std::vector<Terms> terms;               // of every entry off the diagonal
  std::vector<Geometry> geometry;         // the same
  std::vector<Geometry> own;              // of every row, on the diagonal
  std::vector<Coefficients> tet_means;    // of every vertex, over the tets around it by volume
  std::vector<Coefficients> at_vertices;  // the material there

  std::uint32_t count() const { return static_cast<std::uint32_t>(rows.size()); }
  std::size_t entries() const { return rows.column.size(); }
};

// Throws as `assemble` does. `problem.method` is fem; `at_vertices` has the material at every vertex.
Matrix matrix_of(const Level& level, const Problem& problem, std::span<const gpu::Optical> at_vertices);

// The operator whose coefficients on an edge are the mean of those at its vertices, on the diagonal those of its own
// vertex.
Rows edge_averaged(const Matrix& matrix, std::span<const Coefficients> coefficients);

// Sum of row i, diagonal included, without cancellation of the stiffness.
Block row_sum(const Rows& rows, std::uint32_t i);

// `copies` bodies beside each other, each filled up to whole slices with rows of the identity, so that the operator
// outgrows any cache.
Matrix repeated(const Matrix& matrix, std::uint32_t copies);

}  // namespace quadgraph::layouts
