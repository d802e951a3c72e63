// The one operator format, in double precision, and the two discretisations assembled on the CPU. The GPU assembles
// the same rows in single precision (shaders/assemble_*.comp).
//
// Every discretisation is written as a symmetric system A x = b per channel, with phi = to_phi * x.
//
// fem: x = phi at the tet vertices; to_phi = 1. kappa and sigma_a are constant per tet (the value at its inner node).
//   A = stiffness(kappa) + mass(sigma_a) + boundary mass / (2A);  b = integral of Q/(2A) against the basis, Q =
//   4q/(1-F_dr) with q constant per outside face.
//
// quadgraph-fdm: x = u = kappa*phi at the nodes, to_phi = 1/kappa. In u the published rows (Eq. 5) have the purely
//   geometric weights 1/d^2, and the surface rows (Eq. 6), multiplied by kappa_k / (2 A kappa_s d), get the same
//   weight, so the matrix is symmetric. Multiplying rows and changing variables by a diagonal leaves the published
//   relaxation (Eq. 8-9) unchanged.
//     inner i:    (sum_j 1/d_ij^2 + sigma_a/kappa) u_i - sum_j u_j / d_ij^2 = 0
//     surface s:  (1 + h) kappa_k / (kappa_s h d^2) u_s - u_k / d^2 = kappa_k Q / (2 A kappa_s d),  h = 2 A kappa_s / d
//
// quadgraph-fv: x = phi at the nodes, to_phi = 1. Two-point flux across every face, d measured along its normal; the
//   Robin condition in series at the surface. An M-matrix: phi is never negative; conserves energy; exact in layers
//   whose links cross the interfaces at right angles, not consistent on general tets (physics.md, "Discretisations").
//     inner i:    sum_j g_ij (phi_i - phi_j) + sigma_a V phi_i = 0,   g_ij = area / (d_i/kappa_i + d_j/kappa_j)
//     surface s:  (g + area/(2A)) phi_s - g phi_k = area Q / (2A),    g = area kappa_k / d_k
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/graph/graph.h"
#include "engine/graph/solution.h"
#include "shaders/shared.h"

namespace quadgraph {

// Compressed rows without the diagonal. (A x)_i = diagonal_i x_i + sum_k weight_k x_column_k, per channel.
struct Rows {
  std::vector<std::uint32_t> offset;  // n + 1
  std::vector<std::uint32_t> column;  // ascending within a row
  std::vector<glm::dvec3> weight;
  std::vector<glm::dvec3> diagonal;  // n
  std::vector<glm::dvec3> to_phi;    // n

  std::size_t size() const { return diagonal.size(); }
};

// Unknowns of a method on a level.
std::uint32_t unknown_count(const Level& level, Method method);

// `optical` has one entry per node of the level (inner, then surface). Throws InputError if sizes or values are out of
// range (sigma_s_prime, sigma_a >= 0 and finite; eta in [min_eta, max_eta]).
Rows assemble(const Level& level, Method method, std::span<const gpu::Optical> optical, double eta);

// b for irradiance `q` (one entry per surface node, >= 0).
std::vector<glm::dvec3> right_hand_side(const Level& level, Method method, std::span<const gpu::Optical> optical,
                                        double eta, std::span<const glm::vec3> q);

// y = A x.
std::vector<glm::dvec3> apply(const Rows& rows, std::span<const glm::dvec3> x);

}  // namespace quadgraph
