// One ray of the buried source, in double precision; see source_walk.h.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

#include "engine/reference/source_walk.h"
#include "engine/reference/tet_ray.h"

namespace quadgraph {

class Ray {
 public:
  // What the rays leave is added to `result`.
  Ray(const Level& level, const Problem& problem, WalkResult& result)
      : level_(level), problem_(problem), result_(result), way_(level) {}

  // From the point with coordinates `barycentric` of outside face f, with `power` (W) along `direction` (unit, inside).
  void run(std::uint32_t f, const glm::dvec3& barycentric, const glm::dvec3& direction, const glm::dvec3& power);

 private:
  const gpu::Optical& optical() const { return problem_.optical[way_.tet()]; }
  glm::dvec3 extinction() const { return glm::dvec3(optical().sigma_s_prime) + glm::dvec3(optical().sigma_a); }
  glm::dvec3 albedo() const;
  bool ended() const;
  void scatter(const TetRay::Exit& exit);
  void deposit(std::size_t k, int c, double watt);
  void stop();
  void meet_surface(std::uint32_t f);

  const Level& level_;
  const Problem& problem_;
  WalkResult& result_;
  TetRay way_;
  glm::dvec3 direction_{0}, power_{0}, start_{0};
};

}  // namespace quadgraph
