#include "engine/scene/harmonic.h"

#include <cmath>

namespace quadgraph {
namespace {

constexpr int most_iterations = 20000;

// The matrix of the free vertices, and what the fixed ones put on its right-hand side.
class Laplacian {
 public:
  Laplacian(const WeightedGraph& graph, const std::vector<char>& fixed) : graph_(graph), diagonal_(fixed.size(), 1.0) {
    for (std::uint32_t v = 0; v < fixed.size(); ++v) {
      if (fixed[v]) continue;
      free_.push_back(v);
      double sum = 0;
      for (std::size_t e = graph.begin[v]; e < graph.begin[v + 1]; ++e) sum += graph.weight[e];
      diagonal_[v] = sum;
    }
  }

  const std::vector<std::uint32_t>& free() const { return free_; }
  double diagonal(std::uint32_t v) const { return diagonal_[v]; }

  // `x` has the values of all vertices; of fixed ones 0 where only the matrix is meant.
  void apply(std::span<const double> x, std::span<double> y) const {
    for (std::uint32_t v : free_) {
      double sum = diagonal_[v] * x[v];
      for (std::size_t e = graph_.begin[v]; e < graph_.begin[v + 1]; ++e) sum -= graph_.weight[e] * x[graph_.to[e]];
      y[v] = sum;
    }
  }

  double product(std::span<const double> a, std::span<const double> b) const {
    double sum = 0;
    for (std::uint32_t v : free_) sum += a[v] * b[v];
    return sum;
  }

 private:
  const WeightedGraph& graph_;
  std::vector<double> diagonal_;
  std::vector<std::uint32_t> free_;
};

}  // namespace

void make_harmonic(const WeightedGraph& graph, const std::vector<char>& fixed, std::span<double> values,
                   double tolerance) {
  const Laplacian matrix(graph, fixed);
  const std::size_t size = values.size();
  std::vector<double> residual(size, 0), step(size, 0), image(size, 0), scaled(size, 0),
      given(values.begin(), values.end());
  for (std::uint32_t v : matrix.free()) given[v] = 0;
  matrix.apply(given, image);
  const double limit = tolerance * std::sqrt(matrix.product(image, image));
  matrix.apply(values, residual);
  for (std::uint32_t v : matrix.free()) residual[v] = -residual[v];
  double last = 1;
  for (int i = 0; i < most_iterations && std::sqrt(matrix.product(residual, residual)) > limit; ++i) {
    for (std::uint32_t v : matrix.free()) scaled[v] = residual[v] / matrix.diagonal(v);
    const double now = matrix.product(residual, scaled), share = i == 0 ? 0 : now / last;
    last = now;
    for (std::uint32_t v : matrix.free()) step[v] = scaled[v] + share * step[v];
    matrix.apply(step, image);
    const double way = now / matrix.product(step, image);
    for (std::uint32_t v : matrix.free()) {
      values[v] += way * step[v];
      residual[v] -= way * image[v];
    }
  }
}

}  // namespace quadgraph
