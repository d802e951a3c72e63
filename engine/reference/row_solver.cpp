#include "engine/reference/row_solver.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/base/error.h"

namespace quadgraph {
namespace {

using Vector = std::vector<Field>;

glm::dvec3 dot(const Vector& a, const Vector& b) {
  glm::dvec3 sum{0};
  for (std::size_t i = 0; i < a.size(); ++i) sum += quadgraph::dot(a[i], b[i]);
  return sum;
}

// r^T D^-1 r, D the diagonal blocks.
glm::dvec3 scaled_norm(const Rows& rows, const Vector& r) {
  glm::dvec3 sum{0};
  for (std::size_t i = 0; i < r.size(); ++i) sum += quadgraph::dot(r[i], solve(rows.diagonal[i], r[i]));
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

// The largest eigenvalue of D^-1 A of linear tets is at most 4: a sum of positive semidefinite matrices has no larger
// quotient than its worst term, and an element of four blocks has none above 4.
constexpr double fem_bound = 4.0;

// Relaxation x += damping D^-1 (b - A x) from x = 0. Damping 1 is the published scheme.
void relax(const Rows& rows, const Vector& b, double damping, const SolveOptions& options, Vector& x,
           LevelReport& report, const std::function<void()>& check) {
  const glm::dvec3 reference = scaled_norm(rows, b);
  for (;;) {
    if (check) check();
    Vector r = quadgraph::apply(rows, x);
    for (std::size_t i = 0; i < r.size(); ++i) r[i] = b[i] - r[i];
    report.residual = relative(scaled_norm(rows, r), reference);
    if (report.residual <= options.tolerance || report.iterations == options.max_iterations) return;
    for (std::size_t i = 0; i < r.size(); ++i) x[i] = x[i] + glm::dvec3(damping) * solve(rows.diagonal[i], r[i]);
    ++report.iterations;
  }
}

// Conjugate gradients preconditioned by the diagonal blocks, every channel with its own step lengths.
void conjugate_gradients(const Rows& rows, const Vector& b, const SolveOptions& options, Vector& x, LevelReport& report,
                         const std::function<void()>& check) {
  const glm::dvec3 reference = scaled_norm(rows, b);
  Vector r = b;
  Vector z(r.size()), p(r.size());
  glm::dvec3 rz_before{0};
  for (;;) {
    if (check) check();
    for (std::size_t i = 0; i < r.size(); ++i) z[i] = solve(rows.diagonal[i], r[i]);
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
      x[i] = x[i] + alpha * p[i];
      r[i] = r[i] - alpha * ap[i];
    }
    rz_before = rz;
    ++report.iterations;
  }
}

}  // namespace

std::vector<Field> solve_rows(const Rows& rows, const std::vector<Field>& b, const SolveOptions& options,
                              LevelReport& report, const std::function<void()>& check) {
  Vector x(rows.size());
  if (symmetric(options.method) && options.solver != SolverKind::cascade && options.solver != SolverKind::jacobi) {
    conjugate_gradients(rows, b, options, x, report, check);
  } else {
    const double damping = options.method == Method::fem ? 2.0 / fem_bound : 1.0;
    relax(rows, b, damping, options, x, report, check);
  }
  report.converged = report.residual <= options.tolerance;
  return x;
}

}  // namespace quadgraph
