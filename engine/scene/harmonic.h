// Values on a graph that are harmonic wherever they are not given.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace quadgraph {

// Vertex v has the edges begin[v] to begin[v + 1] - 1; every edge stands at both of its ends with the same weight.
struct WeightedGraph {
  std::vector<std::size_t> begin;
  std::vector<std::uint32_t> to;
  std::vector<double> weight;  // of a sum that is positive at every vertex that is not fixed
};

// Changes `values`, one for each vertex, where these are not fixed, until sum_j w_ij (v_j - v_i) = 0 to the residual
// `tolerance` relative to that of zeros: conjugate gradients from what is there. The matrix of free vertices must be
// positive definite. Always the same numbers.
void make_harmonic(const WeightedGraph& graph, const std::vector<char>& fixed, std::span<double> values,
                   double tolerance);

}  // namespace quadgraph
