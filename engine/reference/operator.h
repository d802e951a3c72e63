// The one operator format, in double precision, and the discretisations assembled on the CPU. The GPU assembles the
// same rows in single precision (shaders/assemble_*.comp).
//
// Every discretisation is a system A x = b per channel, symmetric but for polygrids, (phi, phi2) = to_phi * x, whose
// entries are blocks.
//
// SP3 (Klose and Larsen 2006; docs/physics.md, "SP3"), written for phi = phi1 - 2/3 phi2, the fluence of scattered
// light, and phi2, is: stiffness of kappa times G = [[1, 2/3], [2/3, 55/63]], mass of diag(sigma_a, 5/9 sigma_t),
// boundary matrix K, source (S, 0). So a method only says four scalars per pair of carriers (Terms,
// engine/reference/block.h), and diffusion is the corner a11 of the same block.
//
// fem: carriers are the tet vertices; to_phi = 1. Coefficients are constant per tet (the value at its inner node);
//   consistent masses. b of the diffuse source = integral of (k11, k12) source q against the basis, q constant per
//   face.
//
// quadgraph-fdm: carriers are the nodes, x = kappa * (phi, phi2), to_phi = 1/kappa. So written the published rows
//   (Eq. 5) have the purely geometric weights 1/d^2, and the surface rows (Eq. 6), multiplied by
//   kappa_k / (2 A kappa_s d), get the same weight, so the matrix is symmetric. Multiplying rows and changing variables
//   by a diagonal leaves the published relaxation (Eq. 8-9) unchanged. With diffusion:
//     inner i:    (sum_j 1/d_ij^2 + sigma_a/kappa) u_i - sum_j u_j / d_ij^2 = S
//     surface s:  kappa_k / (kappa_s d) (1/d + 1/(2 A kappa_s)) u_s - u_k / d^2 = kappa_k Q / (2 A kappa_s d)
//
// quadgraph-fv: carriers are the nodes; to_phi = 1. Two-point flux across every face, d measured along its normal; the
//   boundary condition in series at the surface. With diffusion an M-matrix: phi is never negative. Conserves energy;
//   exact in layers whose links cross the interfaces at right angles, not consistent on general tets (docs/physics.md,
//   "Discretisations").
//     inner i:    sum_j g_ij (phi_i - phi_j) + sigma_a V phi_i = integral of S,   g_ij = area / (d_i/kappa_i +
//     d_j/kappa_j) surface s:  (g + area/(2A)) phi_s - g phi_k = area Q / (2A),                g = area kappa_k / d_k
//
// polygrid, polygrid-divergence: carriers are the tet vertices, nodes of a polygrid. Not symmetric. w: the weights of
//   Appendix B (shaders/assemble/polygrid.h); V: a fourth of the tets around a vertex, A: a third of its open faces;
//   coefficients the mean of the tets around it. Rows are integrals over these, so that loads are those of fem. With
//   diffusion:
//     inner i, divergence: V_i (sum_j w_ij kappa_ij (phi_i - phi_j) + sigma_a phi_i) = S, kappa_ij harmonic
//     inner i, published:  V_i (sum_j w_ij (u_i - u_j) + sigma_a/kappa_i u_i) = S, u = kappa phi, to_phi = 1/kappa
//     surface s behind which lies k: A_s (kappa (phi_s - phi_k)/d + phi_s/(2A)) = A_s Q/(2A), kappa that of s if
//       published, else the harmonic mean
//
// At a reflecting face nothing passes: K = 0 there, and q is ignored.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "engine/base/solve_options.h"
#include "engine/file/graph.h"
#include "engine/reference/block.h"
#include "engine/reference/indices.h"
#include "shaders/shared/shared.h"

namespace quadgraph {

// What is discretised. `model` is never `automatic`.
struct Problem {
  Method method = Method::fem;
  Source source = Source::buried;
  Model model = Model::diffusion;
  std::span<const gpu::Optical> optical;  // one per node of the level (inner, then surface)
  Indices eta = 1;

  Boundaries boundaries() const;
};

// Compressed rows without the diagonal. (A x)_i = diagonal_i x_i + sum_k weight_k x_column_k, per channel.
struct Rows {
  std::vector<std::uint32_t> offset;  // n + 1
  std::vector<std::uint32_t> column;  // ascending within a row
  std::vector<Block> weight;
  std::vector<Block> diagonal;     // n, positive definite
  std::vector<glm::dvec3> to_phi;  // n

  std::size_t size() const { return diagonal.size(); }
};

// The body of each carrier of a method on a level.
std::vector<std::uint32_t> carrier_bodies(const Level& level, Method method);

// Carriers of a method on a level: rows of its operator, each with one unknown (diffusion) or two (sp3).
std::uint32_t carrier_count(const Level& level, Method method);

// Throw InputError unless there are `count` coefficients, all 0 to 1e6 1/mm; unless eta is in [min_eta, max_eta].
void check_optical(std::span<const gpu::Optical> optical, std::size_t count);
void check_eta(double eta);

// The methods that a level has all for.
std::vector<Method> methods_of(const Level& level);

// Throws InputError where a level has not what the method needs.
void check_method(const Level& level, Method method);

// Throws InputError if sizes or values are out of range (sigma_s_prime, sigma_a >= 0 and finite; eta in [min_eta,
// max_eta]) or if the model is `automatic`.
Rows assemble(const Level& level, const Problem& problem);

// b of the diffuse source for irradiance `q` (one entry per outside face, >= 0).
std::vector<Field> diffuse_load(const Level& level, const Problem& problem, std::span<const glm::vec3> q);

// b of the buried source for `scattered` (W per carrier, as engine/reference/source_walk.h gives it).
std::vector<Field> buried_load(const Level& level, const Problem& problem, std::span<const glm::dvec3> scattered);

// y = A x.
std::vector<Field> apply(const Rows& rows, std::span<const Field> x);

}  // namespace quadgraph
