// quadgraph-fv: two-point flux finite volumes on the tets, harmonic means across faces.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "engine/file/geometry.h"
#include "engine/reference/discretisation.h"
#include "shaders/material/optics.h"

namespace quadgraph {
namespace {

// Area (mm^2) and unit normal of the face of `tet` opposite to vertex k, and a point on it.
struct Face {
  glm::dvec3 point, normal;
  double area;
};

Face face_opposite(const Level& level, const glm::uvec4& tet, int k) {
  const glm::dvec3 p(level.vertices[tet[(k + 1) % 4]]);
  const glm::dvec3 cross =
      glm::cross(glm::dvec3(level.vertices[tet[(k + 2) % 4]]) - p, glm::dvec3(level.vertices[tet[(k + 3) % 4]]) - p);
  const double length = glm::length(cross);
  return {p, cross / length, 0.5 * length};
}

double distance_to(const Face& face, const glm::vec3& node) {
  return std::abs(glm::dot(face.normal, glm::dvec3(node) - face.point));
}

// Flux per difference of phi, mm^2, across face k of tet t: area / (d_i/kappa_i + d_j/kappa_j), or area kappa_i / d_i
// to a surface node, which lies in the face.
glm::dvec3 conductance(const Level& level, std::span<const gpu::Optical> optical, std::uint32_t t, int k) {
  const Face face = face_opposite(level, level.tets[t], k);
  const std::uint32_t j = level.links[t][k];
  glm::dvec3 resistance = distance_to(face, level.nodes[t]) / glm::dvec3(gpu::kappa(optical[t]));
  if (j < level.tet_count()) resistance += distance_to(face, level.nodes[j]) / glm::dvec3(gpu::kappa(optical[j]));
  return face.area / resistance;
}

// The face of tet t that links to `node`.
int face_towards(const Level& level, std::uint32_t t, std::uint32_t node) {
  int k = 0;
  while (k < 3 && level.links[t][k] != node) ++k;
  return k;
}

}  // namespace

Rows assemble_fv(const Level& level, const Problem& problem) {
  const Boundary none;
  const Boundaries boundaries = problem.boundaries();
  Rows rows;
  rows.offset.push_back(0);
  rows.to_phi.assign(level.nodes.size(), glm::dvec3(1));
  for (std::uint32_t t = 0; t < level.tet_count(); ++t) {
    std::array<int, 4> order = {0, 1, 2, 3};
    std::sort(order.begin(), order.end(), [&](int a, int b) { return level.links[t][a] < level.links[t][b]; });
    const double volume = tet_volume(level, level.tets[t]);
    Terms own{.absorption = glm::dvec3(problem.optical[t].sigma_a) * volume,
              .relaxation = relaxation_of(problem.optical[t]) * volume};
    for (int k : order) {
      const glm::dvec3 g = conductance(level, problem.optical, t, k);
      rows.column.push_back(level.links[t][k]);
      rows.weight.push_back(block_of({.stiffness = -g}, problem.model, none));
      own.stiffness += g;
    }
    rows.diagonal.push_back(block_of(own, problem.model, none));
    rows.offset.push_back(static_cast<std::uint32_t>(rows.column.size()));
  }
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    const std::uint32_t t = level.face_tets[f];
    const glm::dvec3 g = conductance(level, problem.optical, t, face_towards(level, t, level.tet_count() + f));
    rows.column.push_back(t);
    rows.weight.push_back(block_of({.stiffness = -g}, problem.model, none));
    Terms own{.stiffness = g};
    if (!level.reflecting(f)) own.boundary = glm::dvec3(face_area(level, level.faces[f]));
    rows.diagonal.push_back(block_of(own, problem.model, boundaries.behind(level, f)));
    rows.offset.push_back(static_cast<std::uint32_t>(rows.column.size()));
  }
  return rows;
}

std::vector<glm::dvec3> surface_load_fv(const Level& level, std::span<const glm::vec3> q) {
  std::vector<glm::dvec3> load(level.nodes.size(), glm::dvec3(0));
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    if (level.reflecting(f)) continue;
    load[level.tet_count() + f] = glm::dvec3(q[f]) * face_area(level, level.faces[f]);
  }
  return load;
}

}  // namespace quadgraph
