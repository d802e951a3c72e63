#include "engine/solve/medium_error.h"

#include <algorithm>
#include <cmath>

#include "engine/base/text.h"
#include "engine/reference/elements.h"

namespace quadgraph {
namespace {

// Of what the exitance changes by, the middle's own share: either place is off by as much, each by itself.
const double own_share = std::sqrt(0.5);

// From there on the report says it in words.
constexpr double large = 0.02;

}  // namespace

std::vector<glm::vec3> medium_load(const Level& level, std::span<const gpu::Optical> here,
                                   std::span<const gpu::Optical> there, std::span<const glm::vec3> fluence,
                                   const Listener& listener) {
  std::vector<glm::dvec3> load(level.vertex_count(), glm::dvec3(0));
  for (std::size_t t = 0; t < level.tets.size(); ++t) {
    heed(listener, t);
    if (here[t].sigma_a == there[t].sigma_a && here[t].sigma_s_prime == there[t].sigma_s_prime) continue;
    const ElementCoefficients own = element_of(here[t]), other = element_of(there[t]);
    const ElementCoefficients lacks{.kappa = own.kappa - other.kappa, .absorption = own.absorption - other.absorption};
    add_element_product(level, level.tets[t], lacks, fluence, load);
  }
  return {load.begin(), load.end()};
}

ErrorEstimate medium_error(Perturbation& perturbation, const PerturbedSolution& solution,
                           std::span<const glm::vec3> load) {
  const std::vector<glm::vec3> change = perturbation.exitance(solution, load);
  return perturbation.relative(solution, change, change, glm::dvec3(own_share));
}

void add_medium_error(SolveReport& report, const ErrorEstimate& medium) {
  const auto together = [](double all, double part) { return std::hypot(all, part); };
  if (report.mesh_error) report.mesh_error = by_parts(together, *report.mesh_error, medium);
  if (report.error) report.error = by_parts(together, *report.error, medium);
  if (std::max(medium.whole, medium.unlit) <= large) return;
  report.mesh_warning += (report.mesh_warning.empty() ? "" : "; ") +
                         std::string("the material changes within tets, by which the light is off by about ") +
                         percent_text(medium.whole) +
                         (medium.unlit > 0 ? ", on the unlit side " + percent_text(medium.unlit) : "") +
                         "; a file baked with --for-material, or with more vertices, has less of that";
}

}  // namespace quadgraph
