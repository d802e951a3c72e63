// polygrid, polygrid-divergence: finite differences between the vertices of a polygrid (operator.h).
#include "engine/file/polygrid.h"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>

#include "engine/file/geometry.h"
#include "engine/reference/discretisation.h"
#include "shaders/assemble/polygrid.h"
#include "shaders/material/optics.h"

namespace quadgraph {
namespace {

// Coefficients at the vertices: the mean of the tets around each, by volume; and a fourth of their volume, mm^3.
struct GridMaterial {
  std::vector<gpu::Optical> optical;
  std::vector<double> volume;
};

GridMaterial grid_material(const Level& level, std::span<const gpu::Optical> optical) {
  const std::size_t count = level.vertices.size();
  std::vector<glm::dvec3> scattering(count, glm::dvec3(0)), absorption(count, glm::dvec3(0));
  GridMaterial material{.optical = {}, .volume = std::vector<double>(count, 0.0)};
  for (std::uint32_t t = 0; t < level.tet_count(); ++t) {
    const double quarter = tet_volume(level, level.tets[t]) / 4;
    for (int k = 0; k < 4; ++k) {
      const std::uint32_t v = level.tets[t][k];
      material.volume[v] += quarter;
      scattering[v] += quarter * glm::dvec3(optical[t].sigma_s_prime);
      absorption[v] += quarter * glm::dvec3(optical[t].sigma_a);
    }
  }
  for (std::size_t v = 0; v < count; ++v) {
    const double volume = material.volume[v];
    material.optical.push_back({glm::vec3(scattering[v] / volume), glm::vec3(absorption[v] / volume)});
  }
  return material;
}

class GridAssembly {
 public:
  GridAssembly(const Level& level, const Problem& problem)
      : level_(level),
        problem_(problem),
        published_(problem.method == Method::polygrid),
        boundary_(problem.boundaries().of(0)),
        material_(grid_material(level, problem.optical)),
        open_area_(surface_load_fem(level, std::vector<glm::vec3>(level.faces.size(), glm::vec3(1)))),
        neighbour_(grid_neighbours(level)) {
    rows_.offset.push_back(0);
    for (std::uint32_t v = 0; v < level.vertex_count(); ++v) {
      rows_.to_phi.push_back(published_ ? 1.0 / kappa(v) : glm::dvec3(1));
      if (v < level.surface_vertex_count) {
        add_surface(v);
      } else {
        add_inner(v);
      }
      rows_.offset.push_back(static_cast<std::uint32_t>(rows_.column.size()));
    }
  }

  Rows take() { return std::move(rows_); }

 private:
  glm::dvec3 kappa(std::uint32_t v) const { return glm::dvec3(gpu::kappa(material_.optical[v])); }

  // Conduction of the link between two vertices, per weight.
  glm::dvec3 between(std::uint32_t a, std::uint32_t b) const {
    if (published_) return glm::dvec3(1);
    return 2.0 * kappa(a) * kappa(b) / (kappa(a) + kappa(b));
  }

  void add(std::uint32_t column, const glm::dvec3& stiffness) {
    rows_.column.push_back(column);
    rows_.weight.push_back(block_of({.stiffness = -stiffness}, problem_.model, boundary_));
  }

  void add_surface(std::uint32_t s) {
    const std::uint32_t k = neighbour_[s];
    const double open = open_area_[s].x;
    const double per_distance =
        (open > 0 ? open : 1.0) / glm::length(glm::dvec3(level_.vertices[s]) - glm::dvec3(level_.vertices[k]));
    add(k, per_distance * (published_ ? kappa(s) / kappa(k) : between(s, k)));
    Terms own{.stiffness = per_distance * between(s, k)};
    own.boundary = published_ ? open / kappa(s) : glm::dvec3(open);
    rows_.diagonal.push_back(block_of(own, problem_.model, boundary_));
  }

  void add_inner(std::uint32_t v) {
    gpu::GridOffsets offsets;
    std::array<std::uint32_t, grid_link_count> order{0, 1, 2, 3, 4, 5};
    for (std::uint32_t k = 0; k < grid_link_count; ++k) {
      offsets.at[k] = glm::dvec3(level_.vertices[level_.grid_link(v, k)]) - glm::dvec3(level_.vertices[v]);
    }
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return level_.grid_link(v, a) < level_.grid_link(v, b); });
    const gpu::GridWeights weights = gpu::grid_weights(offsets);
    const double volume = material_.volume[v];
    const glm::dvec3 mass = published_ ? volume / kappa(v) : glm::dvec3(volume);
    const gpu::Optical& optical = material_.optical[v];
    Terms own{.absorption = glm::dvec3(optical.sigma_a) * mass, .relaxation = relaxation_of(optical) * mass};
    for (const std::uint32_t k : order) {
      const std::uint32_t other = level_.grid_link(v, k);
      if (other == v) continue;
      const glm::dvec3 stiffness = weights.at[k] * volume * between(v, other);
      add(other, stiffness);
      own.stiffness += stiffness;
    }
    rows_.diagonal.push_back(block_of(own, problem_.model, boundary_));
  }

  const Level& level_;
  const Problem& problem_;
  bool published_;
  Boundary boundary_;
  GridMaterial material_;
  std::vector<glm::dvec3> open_area_;  // mm^2 of each vertex, a third of its open faces
  std::vector<std::uint32_t> neighbour_;
  Rows rows_;
};

}  // namespace

Rows assemble_polygrid(const Level& level, const Problem& problem) {
  return GridAssembly(level, problem).take();
}

}  // namespace quadgraph
