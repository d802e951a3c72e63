#include "engine/reference/even_exitance.h"

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "engine/optics/surface_boundary.h"
#include "engine/reference/entering.h"
#include "shaders/shared/creases.h"
#include "shaders/surface/near_return.h"

namespace quadgraph {
namespace {

struct EvenFace {
  glm::dvec3 far{0}, share{0}, normal{0};
  double area = 0;
  bool lit = false;
};

EvenFace even_face(const Level& level, const gpu::Optical& optical, float kept, std::uint32_t f, const glm::dvec3& q,
                   const glm::dvec3& exitance) {
  const FaceFrame frame = frame_of(level, f);
  double squared = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 edge = frame.corners[(k + 1) % 3] - frame.corners[k];
    squared += glm::dot(edge, edge) / 3;
  }
  const glm::dvec3 share(gpu::evened_share(optical, static_cast<float>(std::sqrt(squared))));
  const glm::dvec3 near = glm::min(glm::dvec3(gpu::near_return(optical, kept)) * q, exitance);
  return {exitance - near, share, frame.normal, frame.area, q != glm::dvec3(0)};
}

// What the open faces around a vertex bring one of them, W/mm^2.
glm::dvec3 brought(std::span<const EvenFace> faces, std::span<const std::uint32_t> around, const EvenFace& face) {
  glm::dvec3 sum(0), weight(0);
  for (const std::uint32_t g : around) {
    const EvenFace& other = faces[g];
    const glm::dvec3 coarse = other.area * other.share;
    weight += coarse;
    if (other.lit != face.lit) continue;
    const float smooth = gpu::smooth_share(static_cast<float>(glm::dot(face.normal, other.normal)));
    sum += double{smooth} * coarse * (other.far - face.far);
  }
  for (int c = 0; c < 3; ++c) sum[c] = weight[c] > 0 ? sum[c] / weight[c] : 0;
  return sum;
}

}  // namespace

void make_even(const Level& level, const Problem& problem, std::span<const glm::dvec3> q,
               std::vector<glm::dvec3>& exitance) {
  OfBodies<float> kept;
  for (const double eta : problem.eta.values) kept.values.push_back(static_cast<float>(2 * fresnel_moment(1, eta)));
  std::vector<EvenFace> faces(level.face_count());
  std::vector<std::vector<std::uint32_t>> around(level.vertices.size());
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    if (level.reflecting(f)) continue;
    faces[f] = even_face(level, problem.optical[level.face_tets[f]], kept.behind(level, f), f, q[f], exitance[f]);
    for (int k = 0; k < 3; ++k) around[level.faces[f][k]].push_back(f);
  }
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    if (level.reflecting(f)) continue;
    for (int k = 0; k < 3; ++k)
      exitance[f] += faces[f].share / 3.0 * brought(faces, around[level.faces[f][k]], faces[f]);
  }
}

}  // namespace quadgraph
