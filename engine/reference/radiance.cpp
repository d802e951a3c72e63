#include "engine/reference/radiance.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/gtx/component_wise.hpp>

#include "engine/optics/fresnel.h"
#include "engine/reference/attenuation.h"
#include "engine/reference/entering.h"
#include "engine/reference/tet_ray.h"
#include "shaders/gather/gather_shared.h"

namespace quadgraph {
namespace {

// Values at the two ends of a segment.
struct Ends {
  glm::dvec3 from, to;
};

class View {
 public:
  View(const Level& level, const Problem& problem, const InsideLight& light)
      : level_(level), problem_(problem), light_(light), ray_(level) {}

  Gathered run(std::uint32_t f, const glm::dvec3& barycentric, glm::dvec3 direction) {
    ray_.start_on_face(f, barycentric);
    for (std::uint32_t step = 0; step < gpu::GATHER_STEPS; ++step) {
      const TetRay::Exit exit = ray_.find_exit(direction);
      if (!exit.found) break;
      cross(exit);
      const std::uint32_t next = ray_.leave(exit);
      if (ended()) break;
      if (next < level_.tet_count()) {
        ray_.enter(next);
      } else {
        direction = meet_surface(next - level_.tet_count(), direction);
      }
    }
    gathered_.radiance += left_ * even_radiance();
    return gathered_;
  }

 private:
  const gpu::Optical& optical() const { return problem_.optical[ray_.tet()]; }
  glm::dvec3 extinction() const { return glm::dvec3(optical().sigma_s_prime) + glm::dvec3(optical().sigma_a); }

  Ends ends(std::span<const glm::dvec3> values, const TetRay::Exit& exit) const {
    return {ray_.at_point(values), ray_.at_exit(values, exit)};
  }

  void cross(const TetRay::Exit& exit) {
    const Ends phi = ends(light_.phi, exit), entry = ends(light_.uncollided.entry, exit),
               depth = ends(light_.uncollided.depth, exit);
    for (int c = 0; c < 3; ++c) {
      const double tau = extinction()[c] * exit.length;
      const double x = tau + depth.to[c] - depth.from[c];  // along the ray the light may become brighter
      const double uncollided = x >= 0 ? std::exp(-depth.from[c]) * weighted(entry.from[c], entry.to[c], x)
                                       : std::exp(-depth.to[c] - tau) * weighted(entry.to[c], entry.from[c], -x);
      const double fluence = weighted(phi.from[c], phi.to[c], tau) + uncollided;
      const double scattering = optical().sigma_s_prime[c] / (4 * glm::pi<double>());
      gathered_.radiance[c] += left_[c] * scattering * exit.length * fluence;
      left_[c] *= std::exp(-tau);
    }
  }

  // Whether what lies behind the ray's point matters little.
  bool ended() const {
    const glm::dvec3 even = even_radiance();
    for (int c = 0; c < 3; ++c) {
      if (left_[c] > static_cast<double>(gpu::GATHER_END)) return false;
      if (left_[c] > static_cast<double>(gpu::GATHER_LEAST) &&
          left_[c] * even[c] > static_cast<double>(gpu::GATHER_END) * gathered_.radiance[c])
        return false;
    }
    return true;
  }

  // Mirrors the ray, by the share that stays inside.
  glm::dvec3 meet_surface(std::uint32_t f, const glm::dvec3& direction) {
    const glm::dvec3 flat = ray_.face_normal();
    if (level_.reflecting(f)) return mirrored(direction, flat);
    const glm::dvec3 normal = light_.normals.empty() ? flat : smooth_normal(f);
    const double cosine = std::clamp(glm::dot(direction, normal), 0.0, 1.0);
    const double kept = internal_reflectance(cosine, problem_.eta);
    const glm::dvec3 through = (1 - kept) * left_;
    if (kept < 1) {
      glm::dvec3 point(0);
      for (std::size_t k = 0; k < 4; ++k) point += ray_.corner(k).lambda * ray_.corner(k).position;
      const double outside = std::sqrt(std::max(1 - problem_.eta * problem_.eta * (1 - cosine * cosine), 0.0));
      const glm::dvec3 way = glm::normalize(problem_.eta * (direction - cosine * normal) + outside * normal);
      gathered_.escapes.push_back({through, f, point, outward_of(flat, way)});
    }
    left_ *= kept;
    return -outward_of(flat, 2 * cosine * normal - direction);
  }

  // `way`, turned out of the face of normal `flat` if it is not.
  static glm::dvec3 outward_of(const glm::dvec3& flat, const glm::dvec3& way) {
    return glm::normalize(way + std::max(double{gpu::LEAST_VIEW_COSINE} - glm::dot(way, flat), 0.0) * flat);
  }

  // At the ray's point, on outside face f opposite to corner 3.
  glm::dvec3 smooth_normal(std::uint32_t f) const {
    glm::dvec3 barycentric(0);
    for (int k = 0; k < 3; ++k) {
      for (std::size_t c = 0; c < 3; ++c) {
        if (ray_.corner(c).vertex == level_.faces[f][k]) barycentric[k] = ray_.corner(c).lambda;
      }
    }
    return normal_at(light_.normals[f], barycentric);
  }

  // Radiance at the ray's point, were all behind it as it is there; 0 in a clear region.
  glm::dvec3 even_radiance() const {
    const glm::dvec3 sigma_t = extinction();
    const glm::dvec3 fluence = ray_.at_point(light_.phi) + ray_.at_point(light_.uncollided.entry) *
                                                               glm::exp(-ray_.at_point(light_.uncollided.depth));
    glm::dvec3 radiance(0);
    for (int c = 0; c < 3; ++c) {
      if (sigma_t[c] > 0) radiance[c] = optical().sigma_s_prime[c] / (sigma_t[c] * 4 * glm::pi<double>()) * fluence[c];
    }
    return radiance;
  }

  const Level& level_;
  const Problem& problem_;
  const InsideLight& light_;
  TetRay ray_;
  glm::dvec3 left_{1};  // e^-tau, less what left through faces
  Gathered gathered_;
};

}  // namespace

Gathered gather(const Level& level, const Problem& problem, const InsideLight& light, std::uint32_t f,
                const glm::dvec3& barycentric, const glm::dvec3& direction) {
  return View(level, problem, light).run(f, barycentric, direction);
}

glm::dvec3 gathered_radiance(const Level& level, const Problem& problem, const InsideLight& light, std::uint32_t f,
                             const glm::dvec3& barycentric, const glm::dvec3& outside) {
  const glm::dvec3 normal = frame_of(level, f).normal;
  const glm::dvec3 inward = refract(-outside, normal, problem.eta);
  const double mu = std::min(-glm::dot(inward, normal), 1.0);
  const double leaves = (1 - internal_reflectance(mu, problem.eta)) / (problem.eta * problem.eta);
  return leaves * gather(level, problem, light, f, barycentric, inward).radiance;
}

std::vector<glm::dvec3> gathered_exitance(const Level& level, const Problem& problem, const InsideLight& light) {
  std::vector<glm::dvec3> exitance(level.faces.size(), glm::dvec3(0));
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    if (level.reflecting(f)) continue;
    const auto directions = lambertian_directions(frame_of(level, f), f, problem.eta);
    for (std::size_t k = 0; k < gpu::LAMBERTIAN_NODES; ++k) {
      const double leaves = fresnel_transmittance(std::sqrt(static_cast<double>(gpu::LAMBERTIAN_U[k])), problem.eta);
      const glm::dvec3& direction = directions[2 * k + k / 2];
      exitance[f] += glm::pi<double>() * static_cast<double>(gpu::LAMBERTIAN_W[k]) * leaves /
                     (problem.eta * problem.eta) *
                     gather(level, problem, light, f, glm::dvec3(1.0 / 3), direction).radiance;
    }
  }
  return exitance;
}

}  // namespace quadgraph
