#include "engine/optics/rough_boundary.h"

#include <algorithm>
#include <cmath>

#include "engine/optics/fresnel.h"
#include "shaders/shared/microfacets.h"

namespace quadgraph {
namespace {

constexpr int facets = 16;  // of each of the two numbers that a facet is drawn by

}  // namespace

double rough_reflectance(double cosine, double alpha, double eta) {
  if (eta == 1.0) return 0.0;
  if (alpha == 0.0) return 1 - fresnel_transmittance(cosine, eta);
  const float z = std::max(static_cast<float>(cosine), gpu::LEAST_SEEN_COSINE), rough = static_cast<float>(alpha);
  const glm::vec3 way(std::sqrt(std::max(1 - z * z, 0.0f)), 0, z);
  double sum = 0;
  for (int i = 0; i < facets; ++i) {
    for (int j = 0; j < facets; ++j) {
      const glm::vec3 facet = gpu::visible_facet(way, rough, (glm::vec2(i, j) + 0.5f) / static_cast<float>(facets));
      const double seen = std::clamp(static_cast<double>(glm::dot(way, facet)), 0.0, 1.0);
      sum += (1 - fresnel_transmittance(seen, eta)) * static_cast<double>(gpu::gone_for_good(way, facet, rough));
    }
  }
  return sum / (facets * facets);
}

}  // namespace quadgraph
