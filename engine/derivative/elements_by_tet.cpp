#include "engine/derivative/elements_by_tet.h"

#include <algorithm>
#include <cstddef>

#include "shaders/material/optics.h"

namespace quadgraph {
namespace {

const double floor_of_extinction{gpu::SIGMA_T_MIN};
constexpr double relaxed = 5.0 / 9.0;  // of sigma_t

// The derivatives of an element by sigma_t.
struct ByExtinction {
  glm::dvec3 kappa{0}, relaxation{0};
};

ByExtinction by_extinction(const glm::dvec3& sigma_t) {
  ByExtinction by;
  for (int c = 0; c < 3; ++c) {
    if (sigma_t[c] <= floor_of_extinction) continue;
    by.kappa[c] = -1 / (3 * sigma_t[c] * sigma_t[c]);
    by.relaxation[c] = relaxed;
  }
  return by;
}

}  // namespace

std::vector<ElementCoefficients> elements_of(const Parameters& at) {
  std::vector<ElementCoefficients> elements;
  for (std::size_t t = 0; t < at.scattering.size(); ++t) {
    const glm::dvec3 sigma_t = glm::max(at.scattering[t] + at.absorption[t], glm::dvec3(floor_of_extinction));
    elements.push_back({1.0 / (3.0 * sigma_t), at.absorption[t], relaxed * sigma_t});
  }
  return elements;
}

std::vector<ElementCoefficients> elements_along(const Parameters& at, const Parameters& along) {
  std::vector<ElementCoefficients> elements;
  for (std::size_t t = 0; t < at.scattering.size(); ++t) {
    const ByExtinction by = by_extinction(at.scattering[t] + at.absorption[t]);
    const glm::dvec3 change = along.scattering[t] + along.absorption[t];
    elements.push_back({by.kappa * change, along.absorption[t], by.relaxation * change});
  }
  return elements;
}

void add_by_elements(const Parameters& at, const std::vector<ElementCoefficients>& weights, double factor,
                     Parameters& gradient) {
  for (std::size_t t = 0; t < weights.size(); ++t) {
    const ByExtinction by = by_extinction(at.scattering[t] + at.absorption[t]);
    const glm::dvec3 both = factor * (by.kappa * weights[t].kappa + by.relaxation * weights[t].relaxation);
    gradient.scattering[t] += both;
    gradient.absorption[t] += both + factor * weights[t].absorption;
  }
}

}  // namespace quadgraph
