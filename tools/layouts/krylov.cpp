#include "tools/layouts/krylov.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace quadgraph::layouts {
namespace {

constexpr double tolerance = 1e-10;
constexpr std::uint32_t most_iterations = 3000;

// Step lengths of one channel. They make a tridiagonal matrix whose eigenvalues approach those of D^-1 A from within
// [Saad 2003, 6.7.3].
struct Steps {
  std::vector<double> alpha, beta;

  // Smallest eigenvalue in (0, 4), by bisection.
  double least() const {
    double low = 0, high = 4;
    for (int k = 0; k < 60; ++k) (any_below((low + high) / 2) ? high : low) = (low + high) / 2;
    return high;
  }

 private:
  bool any_below(double value) const {
    double pivot = 1;
    for (std::size_t k = 0; k < alpha.size(); ++k) {
      const double before = k > 0 ? beta[k - 1] / alpha[k - 1] : 0;
      const double square = k > 0 ? before / alpha[k - 1] : 0;
      pivot = 1 / alpha[k] + before - value - square / pivot;
      if (pivot < 0) return true;
    }
    return false;
  }
};

class Iteration {
 public:
  Iteration(const Rows& rows, std::span<const Field> b)
      : rows_(rows), r_(b.begin(), b.end()), p_(rows.size()), solved_{std::vector<Field>(rows.size()), 0, {}} {}

  Solved run() {
    const glm::dvec3 start = residual();
    for (glm::dvec3 rz = start; solved_.iterations < most_iterations; rz = residual()) {
      open_ = glm::greaterThan(rz, tolerance * tolerance * start);
      if (!glm::any(open_)) break;
      if (!step(rz)) return std::move(solved_);
    }
    double least = HUGE_VAL;
    for (const Steps& steps : steps_) least = std::min(least, steps.least());
    solved_.least = least;
    return std::move(solved_);
  }

 private:
  // r^T D^-1 r.
  glm::dvec3 residual() const {
    glm::dvec3 sum{0};
    for (std::size_t i = 0; i < r_.size(); ++i) sum += dot(r_[i], quadgraph::solve(rows_.diagonal[i], r_[i]));
    return sum;
  }

  // False where the matrix is not positive definite.
  bool step(const glm::dvec3& rz) {
    glm::dvec3 alpha{0}, beta{0}, energy{0};
    for (int c = 0; c < 3; ++c) {
      if (open_[c] && solved_.iterations > 0) steps_[c].beta.push_back(beta[c] = rz[c] / before_[c]);
    }
    for (std::size_t i = 0; i < p_.size(); ++i) p_[i] = quadgraph::solve(rows_.diagonal[i], r_[i]) + beta * p_[i];
    const std::vector<Field> ap = quadgraph::apply(rows_, p_);
    for (std::size_t i = 0; i < p_.size(); ++i) energy += dot(p_[i], ap[i]);
    for (int c = 0; c < 3; ++c) {
      if (open_[c] && !(energy[c] > 0)) return false;
      if (open_[c]) steps_[c].alpha.push_back(alpha[c] = rz[c] / energy[c]);
    }
    for (std::size_t i = 0; i < p_.size(); ++i) {
      solved_.x[i] = solved_.x[i] + alpha * p_[i];
      r_[i] = r_[i] - alpha * ap[i];
    }
    before_ = rz;
    ++solved_.iterations;
    return true;
  }

  const Rows& rows_;
  std::vector<Field> r_, p_;
  Solved solved_;
  std::array<Steps, 3> steps_;
  glm::bvec3 open_{true};
  glm::dvec3 before_{0};
};

}  // namespace

Solved solve(const Rows& rows, std::span<const Field> b) {
  return Iteration(rows, b).run();
}

}  // namespace quadgraph::layouts
