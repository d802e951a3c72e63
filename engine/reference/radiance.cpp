#include "engine/reference/radiance.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

#include "engine/optics/fresnel.h"
#include "engine/reference/entering.h"
#include "engine/reference/view_ray.h"
#include "shaders/gather/gather_shared.h"

namespace quadgraph {
namespace {

// Light inside as it is.
class PlainInside {
 public:
  explicit PlainInside(const InsideLight& light) : light_(light) {}

  InsideValues<double> at(std::uint32_t v, int c) const {
    return {light_.phi[v][c], light_.uncollided.entry[v][c], light_.uncollided.depth[v][c]};
  }

 private:
  const InsideLight& light_;
};

}  // namespace

Gathered gather(const Level& level, const Problem& problem, const InsideLight& light, std::uint32_t f,
                const glm::dvec3& barycentric, const glm::dvec3& direction) {
  const Medium medium(problem.optical);
  const PlainInside inside(light);
  ViewRay ray(level, problem, medium, inside, light.normals);
  const auto radiance = ray.run(f, barycentric, direction);
  return {{radiance[0], radiance[1], radiance[2]}, ray.escapes()};
}

Inward inward_of(const Level& level, double eta, std::uint32_t f, const glm::dvec3& outside) {
  const glm::dvec3 normal = frame_of(level, f).normal;
  const glm::dvec3 inward = refract(-outside, normal, eta);
  const double mu = std::min(-glm::dot(inward, normal), 1.0);
  return {inward, (1 - internal_reflectance(mu, eta)) / (eta * eta)};
}

glm::dvec3 gathered_radiance(const Level& level, const Problem& problem, const InsideLight& light, std::uint32_t f,
                             const glm::dvec3& barycentric, const glm::dvec3& outside) {
  const Inward inward = inward_of(level, problem.eta.behind(level, f), f, outside);
  return inward.leaves * gather(level, problem, light, f, barycentric, inward.direction).radiance;
}

std::vector<glm::dvec3> gathered_exitance(const Level& level, const Problem& problem, const InsideLight& light) {
  std::vector<glm::dvec3> exitance(level.faces.size(), glm::dvec3(0));
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    if (level.reflecting(f)) continue;
    const double eta = problem.eta.behind(level, f);
    const auto directions = lambertian_directions(frame_of(level, f), f, eta);
    for (std::size_t k = 0; k < gpu::LAMBERTIAN_NODES; ++k) {
      const double leaves = fresnel_transmittance(std::sqrt(static_cast<double>(gpu::LAMBERTIAN_U[k])), eta);
      const glm::dvec3& direction = directions[2 * k + k / 2];
      exitance[f] += glm::pi<double>() * static_cast<double>(gpu::LAMBERTIAN_W[k]) * leaves / (eta * eta) *
                     gather(level, problem, light, f, glm::dvec3(1.0 / 3), direction).radiance;
    }
  }
  return exitance;
}

}  // namespace quadgraph
