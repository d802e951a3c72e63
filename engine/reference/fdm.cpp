// quadgraph-fdm: [QG] Eq. 5-6 in u = kappa*phi, symmetrised as operator.h derives.
#include <algorithm>
#include <cmath>

#include "engine/reference/discretisation.h"
#include "shaders/material/optics.h"

namespace quadgraph {
namespace {

double inverse_square_distance(const Level& level, std::uint32_t i, std::uint32_t j) {
  const glm::dvec3 d = glm::dvec3(level.nodes[i]) - glm::dvec3(level.nodes[j]);
  return 1.0 / glm::dot(d, d);
}

void assemble_inner(const Level& level, const Problem& problem, std::uint32_t t, Rows& rows) {
  glm::uvec4 links = level.links[t];
  std::sort(&links[0], &links[0] + 4);
  const gpu::Optical& optical = problem.optical[t];
  const glm::dvec3 kappa(gpu::kappa(optical));
  Terms own{.absorption = glm::dvec3(optical.sigma_a) / kappa, .relaxation = relaxation_of(optical) / kappa};
  for (int k = 0; k < 4; ++k) {
    const glm::dvec3 w(inverse_square_distance(level, t, links[k]));
    rows.column.push_back(links[k]);
    rows.weight.push_back(block_of({.stiffness = -w}, problem.model, {}));
    own.stiffness += w;
  }
  rows.diagonal[t] = block_of(own, problem.model, {});
}

// kappa_k / (kappa_s d) at surface node s behind which lies inner node k: what the published row is multiplied with,
// times 2A.
glm::dvec3 row_factor(const Level& level, const Problem& problem, std::uint32_t f) {
  const std::uint32_t s = level.tet_count() + f, k = level.face_tets[f];
  const double inverse_distance = std::sqrt(inverse_square_distance(level, s, k));
  return glm::dvec3(gpu::kappa(problem.optical[k])) / glm::dvec3(gpu::kappa(problem.optical[s])) * inverse_distance;
}

void assemble_surface(const Level& level, const Problem& problem, const Boundary& boundary, std::uint32_t f,
                      Rows& rows) {
  const std::uint32_t s = level.tet_count() + f, k = level.face_tets[f];
  const double w = inverse_square_distance(level, s, k);
  const glm::dvec3 factor = row_factor(level, problem, f);
  rows.column.push_back(k);
  rows.weight.push_back(block_of({.stiffness = glm::dvec3(-w)}, problem.model, {}));
  Terms own{.stiffness = factor * std::sqrt(w)};
  if (!level.reflecting(f)) own.boundary = factor / glm::dvec3(gpu::kappa(problem.optical[s]));
  rows.diagonal[s] = block_of(own, problem.model, boundary);
}

}  // namespace

Rows assemble_fdm(const Level& level, const Problem& problem) {
  const Boundaries boundaries = problem.boundaries();
  Rows rows;
  rows.diagonal.resize(level.nodes.size());
  rows.offset.push_back(0);
  for (std::uint32_t t = 0; t < level.tet_count(); ++t) {
    assemble_inner(level, problem, t, rows);
    rows.offset.push_back(static_cast<std::uint32_t>(rows.column.size()));
  }
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    assemble_surface(level, problem, boundaries.behind(level, f), f, rows);
    rows.offset.push_back(static_cast<std::uint32_t>(rows.column.size()));
  }
  for (const gpu::Optical& o : problem.optical) rows.to_phi.push_back(1.0 / glm::dvec3(gpu::kappa(o)));
  return rows;
}

std::vector<glm::dvec3> surface_load_fdm(const Level& level, const Problem& problem, std::span<const glm::vec3> q) {
  std::vector<glm::dvec3> load(level.nodes.size(), glm::dvec3(0));
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    if (!level.reflecting(f)) load[level.tet_count() + f] = row_factor(level, problem, f) * glm::dvec3(q[f]);
  }
  return load;
}

}  // namespace quadgraph
