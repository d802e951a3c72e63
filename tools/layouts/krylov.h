// Conjugate gradients in double precision that say how close to singular the matrix is.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/reference/operator.h"

namespace quadgraph::layouts {

struct Solved {
  std::vector<Field> x;
  std::uint32_t iterations = 0;
  // Smallest eigenvalue of D^-1 A that the iteration has seen, worst channel; none if it met a direction of
  // non-positive energy: then the matrix is not positive definite, and x is of no use.
  std::optional<double> least;
};

// Solves A x = b from zero until sqrt(r^T D^-1 r) has fallen by 1e-10 in every channel, in at most 3000 iterations.
Solved solve(const Rows& rows, std::span<const Field> b);

}  // namespace quadgraph::layouts
