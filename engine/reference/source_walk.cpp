#include "engine/reference/source_walk.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "engine/reference/entering.h"
#include "engine/reference/ray.h"

namespace quadgraph {
namespace {

class Beam {
 public:
  Beam(const Level& level, const Problem& problem, const gpu::BeamRecord& beam, WalkResult& result)
      : level_(level), problem_(problem), beam_(beam), ray_(level, problem, result), result_(result) {}

  void light(std::uint32_t f, const Quarters& quarters) {
    const FaceFrame frame = frame_of(level_, f);
    if (even(frame, quarters)) {
      const glm::dvec3 q =
          (glm::dvec3(quarters[0]) + glm::dvec3(quarters[1]) + glm::dvec3(quarters[2]) + glm::dvec3(quarters[3])) / 4.0;
      return from(f, frame, 3, q * frame.area);
    }
    for (std::uint32_t k = 0; k < 4; ++k) from(f, frame, k, glm::dvec3(quarters[k]) * (frame.area / 4));
  }

 private:
  static bool even(const FaceFrame& frame, const Quarters& quarters) {
    const glm::vec3 low = glm::min(glm::min(quarters[0], quarters[1]), glm::min(quarters[2], quarters[3]));
    const glm::vec3 high = glm::max(glm::max(quarters[0], quarters[1]), glm::max(quarters[2], quarters[3]));
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3 edge = frame.corners[(k + 1) % 3] - frame.corners[k];
      longest = std::max(longest, glm::dot(edge, edge));
    }
    return glm::all(glm::lessThanEqual(high - low, high / 16.0f)) && longest <= 8 * frame.area;
  }

  // From the middle of a quarter; the last is the one in the middle of the face.
  void from(std::uint32_t f, const FaceFrame& frame, std::uint32_t quarter, const glm::dvec3& power) {
    glm::dvec3 barycentric(1.0 / 3);
    if (quarter < 3) {
      barycentric = glm::dvec3(1.0 / 6);
      barycentric[static_cast<int>(quarter)] = 2.0 / 3;
    }
    if (power == glm::dvec3(0)) return;
    result_.entered += power;
    if (beam_.kind == gpu::BEAM_LAMBERTIAN) return lambertian(f, frame, barycentric, power);
    if (beam_.kind == gpu::BEAM_MEAN) return ray_.run(f, barycentric, mean_direction(frame, f, problem_.eta), power);
    const glm::dvec3 outside = incoming(f, frame, quarter, point_at(frame, barycentric));
    ray_.run(f, barycentric, refract(outside, frame.normal, problem_.eta), power);
  }

  glm::dvec3 incoming(std::uint32_t f, const FaceFrame& frame, std::uint32_t quarter, const glm::dvec3& point) const {
    const glm::dvec3 vector(beam_.travel_or_from);
    if (beam_.kind == gpu::BEAM_DIRECTIONAL) return vector;
    if (beam_.kind == gpu::BEAM_POINT) return glm::normalize(point - vector);
    return rectangle_incoming(beam_, frame, f, quarter, point, problem_.eta);
  }

  void lambertian(std::uint32_t f, const FaceFrame& frame, const glm::dvec3& barycentric, const glm::dvec3& power) {
    const LambertianBundle bundle = lambertian_bundle(problem_.eta);
    const auto directions = lambertian_directions(frame, f, problem_.eta);
    for (std::size_t i = 0; i < directions.size(); ++i) {
      ray_.run(f, barycentric, directions[i], power * (0.5 * bundle.share[i / 2]));
    }
  }

  const Level& level_;
  const Problem& problem_;
  const gpu::BeamRecord& beam_;
  Ray ray_;
  WalkResult& result_;
};

}  // namespace

WalkResult walk_source(const Level& level, const Problem& problem, const gpu::BeamRecord& beam,
                       std::span<const Quarters> quarters) {
  WalkResult result;
  result.scattered.assign(carrier_count(level, problem.method), glm::dvec3(0));
  result.unscattered.assign(level.faces.size(), glm::dvec3(0));
  Beam source(level, problem, beam, result);
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    if (!level.reflecting(f)) source.light(f, quarters[f]);
  }
  return result;
}

}  // namespace quadgraph
