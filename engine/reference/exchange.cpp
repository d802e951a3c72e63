#include "engine/reference/exchange.h"

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>
#include <utility>

#include "engine/file/geometry.h"
#include "engine/optics/surface_boundary.h"

namespace quadgraph {
namespace {

// Share of the directions from face f that meet the body.
double body_visibility(const Level& level, std::uint32_t f) {
  return static_cast<double>(seen_from(level, f).size()) / static_cast<double>(level.seen_rays);
}

bool sees_itself(const Level& level) {
  return level.seen.size() > level.faces.size() + 1;
}

// Light and what of it comes again, bounce by bounce.
class Bounces {
 public:
  Bounces(const Level& level, const Indices& eta, std::span<const EnteringLight> lights, BouncedSolution& result)
      : level_(level), lights_(lights.begin(), lights.end()), result_(result) {
    for (const double index : eta.values) entering_.values.push_back(diffuse_transmittance(index));
    for (const EnteringLight& light : lights) {
      for (std::uint32_t f = 0; f < level.face_count(); ++f) {
        if (!level.reflecting(f)) entered_ += face_area(level, level.faces[f]) * glm::dvec3(light.q[f]);
      }
    }
    result.irradiance.assign(level.faces.size(), glm::dvec3(0));
    result.re_entered.assign(level.faces.size(), glm::vec3(0));
    lights_.push_back({{gpu::BEAM_MEAN, {}, {}, {}}, result.re_entered});
  }

  std::span<const EnteringLight> lights() const { return lights_; }

  // One more bounce of the light in `result`; true if it changed less than `share` of what entered, in every channel.
  bool advance(double share) {
    std::vector<glm::dvec3> radiosity = result_.solution.flux;
    for (std::uint32_t f = 0; f < level_.face_count(); ++f) {
      radiosity[f] += (1.0 - entering_.behind(level_, f)) * result_.irradiance[f];
    }
    const std::vector<glm::dvec3> before = std::exchange(result_.irradiance, received_irradiance(level_, radiosity));
    glm::dvec3 brought{0}, changed{0};
    for (std::uint32_t f = 0; f < level_.face_count(); ++f) {
      const double entering = entering_.behind(level_, f);
      const glm::dvec3 step = entering * (result_.irradiance[f] - before[f]);
      brought += face_area(level_, level_.faces[f]) * step;
      changed += face_area(level_, level_.faces[f]) * glm::abs(step);
      result_.re_entered[f] = entering * result_.irradiance[f];
    }
    result_.bounces.push_back(brought);
    return glm::all(glm::lessThanEqual(changed, share * entered_));
  }

 private:
  const Level& level_;
  OfBodies<double> entering_;
  std::vector<EnteringLight> lights_;
  glm::dvec3 entered_{0};
  BouncedSolution& result_;
};

}  // namespace

std::vector<double> sky_visibility(const Level& level) {
  std::vector<double> sky(level.faces.size(), 1.0);
  if (level.seen.empty()) return sky;
  for (std::uint32_t f = 0; f < level.face_count(); ++f) sky[f] -= body_visibility(level, f);
  return sky;
}

BouncedSolution solve_with_bounces(const Level& level, std::span<const gpu::Optical> optical, const Indices& eta,
                                   std::span<const EnteringLight> lights, const SolveOptions& options,
                                   Entries entries) {
  BouncedSolution result;
  result.solution = solve_reference(level, optical, eta, lights, options, entries);
  if (!bounces_wanted(options) || !sees_itself(level)) return result;
  const glm::dvec3 entered = result.solution.energy.entered;
  Bounces bounces(level, eta, lights, result);
  const std::uint32_t most = options.bounces > 0 ? options.bounces : max_bounces;
  bool settled = false;
  for (std::uint32_t k = 0; k < most && !(settled && options.bounces == 0); ++k) {
    settled = bounces.advance(options.tolerance / 10);
    result.solution = solve_reference(level, optical, eta, bounces.lights(), options, entries);
  }
  result.converged = settled;
  result.solution.energy.re_entered = result.solution.energy.entered - entered;
  result.solution.energy.entered = entered;
  return result;
}

}  // namespace quadgraph
