// One ray of the buried source, in double precision; see source_walk.h.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>

#include "engine/graph/source_walk.h"

namespace quadgraph {

class Ray {
 public:
  // What the rays leave is added to `result`.
  Ray(const Level& level, const Problem& problem, WalkResult& result)
      : level_(level), problem_(problem), result_(result) {}

  // From the point with coordinates `barycentric` of outside face f, with `power` (W) along `direction` (unit, inside).
  void run(std::uint32_t f, const glm::dvec3& barycentric, const glm::dvec3& direction, const glm::dvec3& power);

 private:
  // A vertex of the present tet and the ray's barycentric coordinate. They are carried from tet to tet, so that
  // rounding never takes the ray out of the mesh. Corner 3 is opposite to the face through which the ray came.
  struct Corner {
    std::uint32_t vertex = 0;
    glm::dvec3 position{0};
    double lambda = 0;
  };

  void enter(std::uint32_t f, const glm::dvec3& barycentric);
  void set(std::size_t k, std::uint32_t vertex, double lambda);
  int local_of(std::uint32_t vertex) const;
  const gpu::Optical& optical() const { return problem_.optical[tet_]; }
  glm::dvec3 extinction() const { return glm::dvec3(optical().sigma_s_prime) + glm::dvec3(optical().sigma_a); }
  glm::dvec3 albedo() const;
  bool ended() const;
  int cross();
  void leave(const std::array<double, 4>& lambda, double length);
  void deposit(std::size_t k, int c, double watt);
  void stop();
  void meet_surface(std::uint32_t f);
  void pass_to(std::uint32_t next);

  const Level& level_;
  const Problem& problem_;
  WalkResult& result_;
  std::uint32_t tet_ = 0;
  std::array<Corner, 4> corners_;
  glm::dvec3 direction_{0}, power_{0}, start_{0};
};

}  // namespace quadgraph
