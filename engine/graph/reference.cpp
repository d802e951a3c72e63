#include "engine/graph/reference.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/graph/error.h"
#include "engine/graph/fresnel.h"
#include "engine/graph/geometry.h"
#include "shaders/material.h"

namespace quadgraph {
namespace {

using Vector = std::vector<glm::dvec3>;

glm::dvec3 dot(const Vector& a, const Vector& b) {
  glm::dvec3 sum{0};
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

// r^T D^-1 r.
glm::dvec3 scaled_norm(const Rows& rows, const Vector& r) {
  glm::dvec3 sum{0};
  for (std::size_t i = 0; i < r.size(); ++i) sum += r[i] * r[i] / rows.diagonal[i];
  return sum;
}

// Worst channel of sqrt(r^T D^-1 r / b^T D^-1 b); channels without light count as solved. Throws SolverError if it is
// no number any more, which every comparison with a tolerance would let pass.
double relative(const glm::dvec3& r, const glm::dvec3& b) {
  double worst = 0;
  for (int c = 0; c < 3; ++c) {
    if (b[c] == 0) continue;
    const double residual = std::sqrt(r[c] / b[c]);
    if (!std::isfinite(residual)) {
      throw SolverError("the residual in channel " + std::to_string(c) +
                        " is not finite: the iteration diverged, or a tet or a link is too small for the operator");
    }
    worst = std::max(worst, residual);
  }
  return worst;
}

glm::dvec3 safe_ratio(const glm::dvec3& a, const glm::dvec3& b) {
  glm::dvec3 result{0};
  for (int c = 0; c < 3; ++c) {
    if (b[c] > 0) result[c] = a[c] / b[c];
  }
  return result;
}

// Guaranteed bound of the spectrum of D^-1 A of fem over all channels: Gershgorin, and 4 for linear tets,
// because a sum of element matrices has no larger quotient than its worst element, whose trace after scaling is 4.
double spectral_bound(const Rows& rows) {
  double bound = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    glm::dvec3 sum = rows.diagonal[i];
    for (std::uint32_t k = rows.offset[i]; k < rows.offset[i + 1]; ++k) sum += glm::abs(rows.weight[k]);
    const glm::dvec3 ratio = sum / rows.diagonal[i];
    bound = std::max({bound, ratio[0], ratio[1], ratio[2]});
  }
  return std::min(bound, 4.0);
}

// Relaxation x += damping D^-1 (b - A x) from x = 0. Damping 1 is the published scheme.
void relax(const Rows& rows, const Vector& b, double damping, const SolveOptions& options, Vector& x,
           LevelReport& report) {
  const glm::dvec3 reference = scaled_norm(rows, b);
  for (;;) {
    Vector r = quadgraph::apply(rows, x);
    for (std::size_t i = 0; i < r.size(); ++i) r[i] = b[i] - r[i];
    report.residual = relative(scaled_norm(rows, r), reference);
    if (report.residual <= options.tolerance || report.iterations == options.max_iterations) return;
    for (std::size_t i = 0; i < r.size(); ++i) x[i] += damping * r[i] / rows.diagonal[i];
    ++report.iterations;
  }
}

// Conjugate gradients with diagonal preconditioning, every channel with its own step lengths.
void conjugate_gradients(const Rows& rows, const Vector& b, const SolveOptions& options, Vector& x,
                         LevelReport& report) {
  const glm::dvec3 reference = scaled_norm(rows, b);
  Vector r = b;
  Vector z(r.size()), p(r.size(), glm::dvec3(0));
  glm::dvec3 rz_before{0};
  for (;;) {
    for (std::size_t i = 0; i < r.size(); ++i) z[i] = r[i] / rows.diagonal[i];
    const glm::dvec3 rz = dot(r, z);
    report.residual = relative(rz, reference);
    if (report.residual <= options.tolerance || report.iterations == options.max_iterations) return;
    const glm::dvec3 beta = safe_ratio(rz, rz_before);
    for (std::size_t i = 0; i < p.size(); ++i) p[i] = z[i] + beta * p[i];
    const Vector ap = quadgraph::apply(rows, p);
    const glm::dvec3 curvature = dot(p, ap);
    for (int c = 0; c < 3; ++c) {
      if (rz[c] > 0 && !(curvature[c] > 0)) {
        throw SolverError("conjugate gradients met a direction of non-positive energy in channel " + std::to_string(c) +
                          " at iteration " + std::to_string(report.iterations) +
                          ": the matrix is not positive definite");
      }
    }
    const glm::dvec3 alpha = safe_ratio(rz, curvature);
    for (std::size_t i = 0; i < x.size(); ++i) {
      x[i] += alpha * p[i];
      r[i] -= alpha * ap[i];
    }
    rz_before = rz;
    ++report.iterations;
  }
}

glm::dvec3 face_phi(const Level& level, Method method, const Vector& phi, std::uint32_t f) {
  if (method != Method::fem) return phi[level.tet_count() + f];
  const glm::uvec3& face = level.faces[f];
  return (phi[face[0]] + phi[face[1]] + phi[face[2]]) / 3.0;
}

glm::dvec3 tet_phi(const Level& level, Method method, const Vector& phi, std::uint32_t t) {
  if (method != Method::fem) return phi[t];
  const glm::uvec4& tet = level.tets[t];
  return (phi[tet[0]] + phi[tet[1]] + phi[tet[2]] + phi[tet[3]]) / 4.0;
}

void add_surface(const Level& level, Method method, double eta, std::span<const glm::vec3> q,
                 ReferenceSolution& solution) {
  const double a = mismatch(eta);
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    const double area = face_area(level, level.faces[f]);
    const glm::dvec3 phi = face_phi(level, method, solution.phi, f);
    const glm::dvec3 exitance = (phi - 2.0 * glm::dvec3(q[f])) / (2.0 * a);
    solution.phi_face.push_back(phi);
    solution.exitance.push_back(exitance);
    solution.energy.entered += area * glm::dvec3(q[f]);
    solution.energy.scattered_out += area * exitance;
  }
}

void add_absorbed(const Level& level, Method method, std::span<const gpu::Optical> optical,
                  ReferenceSolution& solution) {
  for (std::uint32_t t = 0; t < level.tet_count(); ++t) {
    solution.energy.absorbed +=
        tet_volume(level, level.tets[t]) * glm::dvec3(optical[t].sigma_a) * tet_phi(level, method, solution.phi, t);
  }
}

}  // namespace

std::vector<gpu::Optical> evaluate_material(const Level& level, const gpu::Material& material) {
  std::vector<gpu::Optical> optical;
  optical.reserve(level.nodes.size());
  for (const glm::vec3& node : level.nodes) optical.push_back(gpu::material_at(material, node));
  return optical;
}

ReferenceSolution solve_reference(const Level& level, std::span<const gpu::Optical> optical, double eta,
                                  std::span<const glm::vec3> q, const SolveOptions& options) {
  const Rows rows = assemble(level, options.method, optical, eta);
  const Vector b = right_hand_side(level, options.method, optical, eta, q);
  ReferenceSolution solution;
  solution.report.unknowns = static_cast<std::uint32_t>(rows.size());
  Vector x(rows.size(), glm::dvec3(0));
  if (options.solver == SolverKind::dpcg) {
    conjugate_gradients(rows, b, options, x, solution.report);
  } else {
    const double damping = options.method == Method::fem ? 2.0 / spectral_bound(rows) : 1.0;
    relax(rows, b, damping, options, x, solution.report);
  }
  solution.report.converged = solution.report.residual <= options.tolerance;
  solution.phi.reserve(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) solution.phi.push_back(rows.to_phi[i] * x[i]);
  add_surface(level, options.method, eta, q, solution);
  add_absorbed(level, options.method, optical, solution);
  return solution;
}

}  // namespace quadgraph
