#include "engine/reference/gather_scale.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>

#include "engine/reference/entering.h"
#include "shaders/gather/gather_shared.h"

namespace quadgraph {
namespace {

// What an open face adds to means.
struct FaceShare {
  glm::dvec3 centre, normal;
  glm::dvec3 exitance, gathered;  // W
  double area;
};

// Where means are taken.
struct Around {
  glm::dvec3 normal{0}, extinction{0};  // sums over area, then unit and 1/mm
  glm::dvec3 gathered{0};               // the same, then W/mm^2
  double edges = 0;                     // mean of their squares, mm^2
  double area = 0;
};

std::vector<Around> around_vertices(const Level& level, const Problem& problem, std::span<const glm::dvec3> gathered) {
  std::vector<Around> around(level.surface_vertex_count);
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    if (level.reflecting(f)) continue;
    const FaceFrame frame = frame_of(level, f);
    const gpu::Optical& optical = problem.optical[level.face_tets[f]];
    double edges = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3 edge = frame.corners[(k + 1) % 3] - frame.corners[k];
      edges += glm::dot(edge, edge) / 3;
    }
    for (int k = 0; k < 3; ++k) {
      Around& at = around[level.faces[f][k]];
      at.normal += frame.area * frame.normal;
      at.extinction += frame.area * (glm::dvec3(optical.sigma_s_prime) + glm::dvec3(optical.sigma_a));
      at.gathered += frame.area * gathered[f];
      at.edges += frame.area * edges;
      at.area += frame.area;
    }
  }
  for (Around& at : around) {
    if (at.area == 0) continue;
    at.normal = glm::normalize(at.normal);
    at.extinction /= at.area;
    at.gathered /= at.area;
    at.edges /= at.area;
  }
  return around;
}

// Per channel, of edges of that optical length.
glm::dvec3 floor_of(const glm::dvec3& edge) {
  return double{gpu::GATHER_FLOOR} * glm::clamp(2.0 * edge / double{gpu::GATHER_LONG} - 1.0, 0.0, 1.0);
}

std::vector<FaceShare> sources_of(const Level& level, std::span<const glm::dvec3> gathered,
                                  std::span<const glm::dvec3> exitance) {
  std::vector<FaceShare> sources;
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    if (level.reflecting(f)) continue;
    const FaceFrame frame = frame_of(level, f);
    const glm::uvec3& ids = level.faces[f];
    const glm::dvec3 mean = (exitance[ids.x] + exitance[ids.y] + exitance[ids.z]) / 3.0;
    sources.push_back(
        {point_at(frame, glm::dvec3(1.0 / 3)), frame.normal, frame.area * mean, frame.area * gathered[f], frame.area});
  }
  return sources;
}

glm::dvec3 weight_of(const FaceShare& source, const Around& at, const glm::dvec3& place, const glm::dvec3& variance) {
  const glm::dvec3 offset = source.centre - place, there = source.gathered / source.area;
  const double reach = double{gpu::GATHER_REACH};
  const glm::dvec3 nearness =
      glm::max(glm::exp(-0.5 * glm::dot(offset, offset) / variance) - std::exp(-0.5 * reach * reach), 0.0);
  glm::dvec3 alike;
  for (int c = 0; c < 3; ++c) {
    const auto [less, more] = std::minmax(there[c], at.gathered[c]);
    alike[c] = std::max(less / std::max(more, 1e-37), double{gpu::GATHER_ALIKE});
  }
  return 0.5 * (1 + glm::dot(at.normal, source.normal)) * alike * nearness;
}

}  // namespace

std::vector<VertexScale> gather_scale(const Level& level, const Problem& problem, std::span<const glm::dvec3> gathered,
                                      std::span<const glm::dvec3> exitance) {
  const std::vector<FaceShare> sources = sources_of(level, gathered, exitance);
  std::vector<VertexScale> scale;
  for (const Around& at : around_vertices(level, problem, gathered)) {
    const glm::dvec3 place(level.vertices[scale.size()]);
    const glm::dvec3 path = 1.0 / glm::max(at.extinction, glm::dvec3(1e-6));
    const glm::dvec3 variance = double{gpu::GATHER_PATH} * path * path + double{gpu::GATHER_EDGE} * at.edges;
    glm::dvec3 wanted(0), found(0), weights(0);
    for (const FaceShare& source : sources) {
      const glm::dvec3 weight = weight_of(source, at, place, variance);
      wanted += weight * source.exitance;
      found += weight * source.gathered;
      weights += weight * source.area;
    }
    VertexScale at_vertex;
    at_vertex.least = floor_of(std::sqrt(at.edges) / path) * exitance[scale.size()];
    for (int c = 0; c < 3 && at.area > 0; ++c) {
      if (found[c] > 0) at_vertex.factor[c] = std::min(wanted[c] / found[c], double{gpu::GATHER_FACTOR_MAX});
      if (weights[c] > 0) at_vertex.rest[c] = std::max(wanted[c] - at_vertex.factor[c] * found[c], 0.0) / weights[c];
    }
    scale.push_back(at_vertex);
  }
  return scale;
}

}  // namespace quadgraph
