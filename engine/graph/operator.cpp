#include "engine/graph/operator.h"

#include <cmath>
#include <string>

#include "engine/graph/discretisation.h"
#include "engine/graph/error.h"
#include "engine/graph/fresnel.h"

namespace quadgraph {
namespace {

bool in_range(const gpu::Optical& optical) {
  for (int c = 0; c < 3; ++c) {
    if (!(optical.sigma_s_prime[c] >= 0 && std::isfinite(optical.sigma_s_prime[c]))) return false;
    if (!(optical.sigma_a[c] >= 0 && std::isfinite(optical.sigma_a[c]))) return false;
  }
  return true;
}

void check_input(const Level& level, std::span<const gpu::Optical> optical, double eta) {
  if (optical.size() != level.nodes.size()) {
    throw InputError("optical: " + std::to_string(optical.size()) + " entries, the level has " +
                     std::to_string(level.nodes.size()) + " nodes");
  }
  for (std::size_t i = 0; i < optical.size(); ++i) {
    if (!in_range(optical[i])) {
      throw InputError("optical[" + std::to_string(i) + "]: sigma_s_prime and sigma_a must be finite numbers >= 0");
    }
  }
  if (!(eta >= min_eta && eta <= max_eta)) throw InputError("eta " + std::to_string(eta) + ": allowed is 1 to 3");
}

}  // namespace

std::uint32_t unknown_count(const Level& level, Method method) {
  return method == Method::fem ? level.vertex_count() : level.node_count();
}

Rows assemble(const Level& level, Method method, std::span<const gpu::Optical> optical, double eta) {
  check_input(level, optical, eta);
  switch (method) {
    case Method::quadgraph_fdm:
      return assemble_fdm(level, optical, eta);
    case Method::quadgraph_fv:
      return assemble_fv(level, optical, eta);
    case Method::fem:
      return assemble_fem(level, optical, eta);
  }
  throw InputError("unknown method");
}

std::vector<glm::dvec3> right_hand_side(const Level& level, Method method, std::span<const gpu::Optical> optical,
                                        double eta, std::span<const glm::vec3> q) {
  check_input(level, optical, eta);
  if (q.size() != level.faces.size()) {
    throw InputError("q: " + std::to_string(q.size()) + " entries, the level has " +
                     std::to_string(level.faces.size()) + " surface nodes");
  }
  for (std::size_t i = 0; i < q.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      if (!(q[i][c] >= 0 && std::isfinite(q[i][c]))) {
        throw InputError("q[" + std::to_string(i) + "]: " + std::to_string(q[i][c]) + ", allowed is a number >= 0");
      }
    }
  }
  switch (method) {
    case Method::quadgraph_fdm:
      return load_fdm(level, optical, eta, q);
    case Method::quadgraph_fv:
      return load_fv(level, eta, q);
    case Method::fem:
      return load_fem(level, eta, q);
  }
  throw InputError("unknown method");
}

std::vector<glm::dvec3> apply(const Rows& rows, std::span<const glm::dvec3> x) {
  std::vector<glm::dvec3> y(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    glm::dvec3 sum = rows.diagonal[i] * x[i];
    for (std::uint32_t k = rows.offset[i]; k < rows.offset[i + 1]; ++k) sum += rows.weight[k] * x[rows.column[k]];
    y[i] = sum;
  }
  return y;
}

}  // namespace quadgraph
