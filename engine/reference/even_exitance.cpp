#include "engine/reference/even_exitance.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "engine/optics/fresnel.h"
#include "engine/reference/entering.h"
#include "shaders/surface/near_return.h"

namespace quadgraph {
namespace {

struct EvenFace {
  glm::dvec3 far{0}, share{0};
  double area = 0;
  std::size_t lit = 0;  // 1: light enters
};

EvenFace even_face(const Level& level, const gpu::Optical& optical, double kept, std::uint32_t f, const glm::dvec3& q,
                   const glm::dvec3& exitance) {
  const FaceFrame frame = frame_of(level, f);
  double squared = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 edge = frame.corners[(k + 1) % 3] - frame.corners[k];
    squared += glm::dot(edge, edge) / 3;
  }
  const glm::dvec3 back(gpu::half_space_return(optical, static_cast<float>(kept)));
  const glm::dvec3 share(gpu::evened_share(optical, static_cast<float>(std::sqrt(squared))));
  return {exitance - glm::min(double{gpu::NEAR_SHARE} * back * q, exitance), share, frame.area,
          q == glm::dvec3(0) ? 0u : 1u};
}

}  // namespace

void make_even(const Level& level, const Problem& problem, std::span<const glm::dvec3> q,
               std::vector<glm::dvec3>& exitance) {
  const double kept = 2 * fresnel_moment(1, problem.eta);
  std::vector<EvenFace> faces(level.face_count());
  std::vector<std::array<glm::dvec3, 2>> sum(level.vertices.size(), {glm::dvec3(0), glm::dvec3(0)}), weight = sum;
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    if (level.reflecting(f)) continue;
    faces[f] = even_face(level, problem.optical[level.face_tets[f]], kept, f, q[f], exitance[f]);
    for (int k = 0; k < 3; ++k) {
      sum[level.faces[f][k]][faces[f].lit] += faces[f].area * faces[f].share * faces[f].far;
      weight[level.faces[f][k]][faces[f].lit] += faces[f].area * faces[f].share;
    }
  }
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    glm::dvec3 mean(0);
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3 &all = sum[level.faces[f][k]][faces[f].lit], &size = weight[level.faces[f][k]][faces[f].lit];
      for (int c = 0; c < 3; ++c) {
        if (size[c] > 0) mean[c] += all[c] / size[c] / 3;
      }
    }
    exitance[f] += faces[f].share * (mean - faces[f].far);
  }
}

}  // namespace quadgraph
