// quadgraph-fdm: [QG] Eq. 5-6 in u = kappa*phi, symmetrised as operator.h derives.
#include <algorithm>
#include <cmath>

#include "engine/graph/discretisation.h"
#include "engine/graph/fresnel.h"
#include "shaders/optics.h"

namespace quadgraph {
namespace {

double inverse_square_distance(const Level& level, std::uint32_t i, std::uint32_t j) {
  const glm::dvec3 d = glm::dvec3(level.nodes[i]) - glm::dvec3(level.nodes[j]);
  return 1.0 / glm::dot(d, d);
}

void assemble_inner(const Level& level, std::span<const gpu::Optical> optical, std::uint32_t t, Rows& rows) {
  glm::uvec4 links = level.links[t];
  std::sort(&links[0], &links[0] + 4);
  double sum = 0;
  for (int k = 0; k < 4; ++k) {
    const double w = inverse_square_distance(level, t, links[k]);
    rows.column.push_back(links[k]);
    rows.weight.emplace_back(-w);
    sum += w;
  }
  rows.diagonal[t] = glm::dvec3(sum) + glm::dvec3(optical[t].sigma_a) / glm::dvec3(gpu::kappa(optical[t]));
}

void assemble_surface(const Level& level, std::span<const gpu::Optical> optical, double a, std::uint32_t f,
                      Rows& rows) {
  const std::uint32_t s = level.tet_count() + f;
  const std::uint32_t k = level.face_tets[f];
  const double w = inverse_square_distance(level, s, k);
  const glm::dvec3 kappa_s(gpu::kappa(optical[s]));
  const glm::dvec3 h = 2.0 * a * kappa_s * std::sqrt(w);
  rows.column.push_back(k);
  rows.weight.emplace_back(-w);
  rows.diagonal[s] = (1.0 + h) * glm::dvec3(gpu::kappa(optical[k])) / (kappa_s * h) * w;
}

}  // namespace

Rows assemble_fdm(const Level& level, std::span<const gpu::Optical> optical, double eta) {
  const double a = mismatch(eta);
  Rows rows;
  rows.diagonal.resize(level.nodes.size());
  rows.offset.push_back(0);
  for (std::uint32_t t = 0; t < level.tet_count(); ++t) {
    assemble_inner(level, optical, t, rows);
    rows.offset.push_back(static_cast<std::uint32_t>(rows.column.size()));
  }
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    assemble_surface(level, optical, a, f, rows);
    rows.offset.push_back(static_cast<std::uint32_t>(rows.column.size()));
  }
  for (const gpu::Optical& o : optical) rows.to_phi.push_back(1.0 / glm::dvec3(gpu::kappa(o)));
  return rows;
}

std::vector<glm::dvec3> load_fdm(const Level& level, std::span<const gpu::Optical> optical, double eta,
                                 std::span<const glm::vec3> q) {
  const double a = mismatch(eta);
  const double source_per_q = 4.0 / (1.0 - internal_diffuse_reflectance(eta));
  std::vector<glm::dvec3> b(level.nodes.size(), glm::dvec3(0));
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    const std::uint32_t s = level.tet_count() + f;
    const std::uint32_t k = level.face_tets[f];
    const double inverse_distance = std::sqrt(inverse_square_distance(level, s, k));
    b[s] = glm::dvec3(gpu::kappa(optical[k])) / glm::dvec3(gpu::kappa(optical[s])) * glm::dvec3(q[f]) * source_per_q *
           inverse_distance / (2.0 * a);
  }
  return b;
}

}  // namespace quadgraph
