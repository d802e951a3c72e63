#include "engine/graph/radiance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/vector_relational.hpp>
#include <optional>

#include "engine/graph/entering.h"
#include "engine/graph/fresnel.h"
#include "engine/graph/tet_ray.h"
#include "shaders/gather_shared.h"

namespace quadgraph {
namespace {

// Integral of e^(-x s) (a + (b - a) s) over s from 0 to 1, x >= 0.
double weighted(double a, double b, double x) {
  double whole, moment;  // of e^(-x s) and of s e^(-x s)
  if (x < 1e-3) {        // the closed forms lose digits; the series is exact to 1e-14
    whole = 1 - x * (0.5 - x * (1.0 / 6 - x * (1.0 / 24 - x / 120)));
    moment = 0.5 - x * (1.0 / 3 - x * (1.0 / 8 - x * (1.0 / 30 - x / 144)));
  } else {
    whole = -std::expm1(-x) / x;
    moment = (whole - std::exp(-x)) / x;
  }
  return a * whole + (b - a) * moment;
}

// Values at the two ends of a segment.
struct Ends {
  glm::dvec3 from, to;
};

// Light along the way, in one direction of those that share it: all lengths are `stretch` times as long.
struct Strand {
  double stretch = 1;
  std::optional<double> reflectance;  // of open faces from inside; none: by the angle
  glm::dvec3 transmitted{1};          // e^-tau, less what left through faces
  Gathered gathered;
};

class View {
 public:
  View(const Level& level, const Problem& problem, const InsideLight& light)
      : level_(level), problem_(problem), light_(light), ray_(level) {}

  void run(std::uint32_t f, const glm::dvec3& barycentric, glm::dvec3 direction, std::span<Strand> strands) {
    ray_.start_on_face(f, barycentric);
    thin_ = false;
    for (std::uint32_t step = 0; step < gpu::GATHER_STEPS; ++step) {
      const TetRay::Exit exit = ray_.find_exit(direction);
      if (!exit.found) break;
      cross(exit, strands);
      const std::uint32_t next = ray_.leave(exit);
      if (ended(strands)) break;
      if (next < level_.tet_count()) {
        ray_.enter(next);
      } else {
        direction = meet_surface(next - level_.tet_count(), direction, strands);
      }
    }
    for (Strand& strand : strands) strand.gathered.radiance += strand.transmitted * even_radiance();
  }

  // Whether the last run saw through the body.
  bool thin() const { return thin_; }

 private:
  const gpu::Optical& optical() const { return problem_.optical[ray_.tet()]; }
  glm::dvec3 extinction() const { return glm::dvec3(optical().sigma_s_prime) + glm::dvec3(optical().sigma_a); }

  Ends ends(std::span<const glm::dvec3> values, const TetRay::Exit& exit) const {
    return {ray_.at_point(values), ray_.at_exit(values, exit)};
  }

  void cross(const TetRay::Exit& exit, std::span<Strand> strands) {
    const Ends phi = ends(light_.phi, exit), entry = ends(light_.uncollided.entry, exit),
               depth = ends(light_.uncollided.depth, exit);
    for (Strand& strand : strands) {
      const double length = exit.length * strand.stretch;
      for (int c = 0; c < 3; ++c) {
        const double tau = extinction()[c] * length;
        const double x = tau + depth.to[c] - depth.from[c];  // along the ray the light may become brighter
        const double uncollided = x >= 0 ? std::exp(-depth.from[c]) * weighted(entry.from[c], entry.to[c], x)
                                         : std::exp(-depth.to[c] - tau) * weighted(entry.to[c], entry.from[c], -x);
        const double fluence = weighted(phi.from[c], phi.to[c], tau) + uncollided;
        const double scattering = optical().sigma_s_prime[c] / (4 * glm::pi<double>());
        strand.gathered.radiance[c] += strand.transmitted[c] * scattering * length * fluence;
        strand.transmitted[c] *= std::exp(-tau);
      }
    }
  }

  // Whether what lies behind the ray's point matters little to every strand.
  bool ended(std::span<const Strand> strands) const {
    const glm::dvec3 even = even_radiance();
    for (const Strand& strand : strands) {
      for (int c = 0; c < 3; ++c) {
        const double kept = strand.transmitted[c];
        if (kept > static_cast<double>(gpu::GATHER_END)) return false;
        if (kept > static_cast<double>(gpu::GATHER_LEAST) &&
            kept * even[c] > static_cast<double>(gpu::GATHER_END) * strand.gathered.radiance[c])
          return false;
      }
    }
    return true;
  }

  // Mirrors the ray, by the share that stays inside.
  glm::dvec3 meet_surface(std::uint32_t f, const glm::dvec3& direction, std::span<Strand> strands) {
    const glm::dvec3 normal = ray_.face_normal();
    for (Strand& strand : strands) {
      if (level_.reflecting(f)) break;
      thin_ = thin_ || glm::any(glm::greaterThan(strand.transmitted, glm::dvec3(gpu::GATHER_END)));
      const double cosine = std::clamp(glm::dot(direction, normal), 0.0, 1.0);
      const double kept = strand.reflectance.value_or(internal_reflectance(cosine, problem_.eta));
      strand.gathered.seen += (1 - kept) * strand.transmitted;
      strand.transmitted *= kept;
    }
    return mirrored(direction, normal);
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
  bool thin_ = false;
};

}  // namespace

Gathered gather(const Level& level, const Problem& problem, const InsideLight& light, std::uint32_t f,
                const glm::dvec3& barycentric, const glm::dvec3& direction) {
  std::array<Strand, 1> strands;
  View(level, problem, light).run(f, barycentric, direction, strands);
  return strands[0].gathered;
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
  std::array<Strand, gpu::LAMBERTIAN_NODES> fresh;
  std::array<double, gpu::LAMBERTIAN_NODES> weight;
  for (std::size_t k = 0; k < fresh.size(); ++k) {
    const double outside = std::sqrt(static_cast<double>(gpu::LAMBERTIAN_U[k]));
    const double mu = refracted_cosine(outside, problem.eta), leaves = fresnel_transmittance(outside, problem.eta);
    fresh[k].stretch = 1 / mu;
    fresh[k].reflectance = 1 - leaves;
    weight[k] = glm::pi<double>() * static_cast<double>(gpu::LAMBERTIAN_W[k]) * leaves / (problem.eta * problem.eta);
  }
  std::vector<glm::dvec3> exitance(level.faces.size(), glm::dvec3(0));
  View view(level, problem, light);
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    if (level.reflecting(f)) continue;
    auto strands = fresh;
    const FaceFrame frame = frame_of(level, f);
    view.run(f, glm::dvec3(1.0 / 3), -frame.normal, strands);
    if (view.thin()) {
      const auto directions = lambertian_directions(frame, f, problem.eta);
      for (Strand& strand : strands) strand.gathered.radiance = glm::dvec3(0);
      for (std::size_t i = 0; i < directions.size(); ++i) {
        strands[i / 2].gathered.radiance +=
            0.5 * gather(level, problem, light, f, glm::dvec3(1.0 / 3), directions[i]).radiance;
      }
    }
    for (std::size_t k = 0; k < strands.size(); ++k) exitance[f] += weight[k] * strands[k].gathered.radiance;
  }
  return exitance;
}

}  // namespace quadgraph
