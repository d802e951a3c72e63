#include "engine/optics/rough_boundary.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "engine/optics/fresnel.h"
#include "shaders/shared/microfacets.h"

namespace quadgraph {
namespace {

constexpr int facets = 16;  // of each of the two numbers that a facet is drawn by

// Of facets that reflect so much of light by its cosine with them.
double mean_reflectance(double cosine, double alpha, const std::function<double(double)>& reflected) {
  if (alpha == 0.0) return reflected(cosine);
  const float z = std::max(static_cast<float>(cosine), gpu::LEAST_SEEN_COSINE), rough = static_cast<float>(alpha);
  const glm::vec3 way(std::sqrt(std::max(1 - z * z, 0.0f)), 0, z);
  double sum = 0;
  for (int i = 0; i < facets; ++i) {
    for (int j = 0; j < facets; ++j) {
      const glm::vec3 facet = gpu::visible_facet(way, rough, (glm::vec2(i, j) + 0.5f) / static_cast<float>(facets));
      const double seen = std::clamp(static_cast<double>(glm::dot(way, facet)), 0.0, 1.0);
      sum += reflected(seen) * static_cast<double>(gpu::gone_for_good(way, facet, rough));
    }
  }
  return sum / (facets * facets);
}

}  // namespace

double coat_reflectance(double cosine, const OpticalSurface& surface) {
  const Coat& coat = surface.coat;
  if (coat.share == 0) return 0;
  return coat.share *
         mean_reflectance(cosine, coat.roughness, [&](double c) { return 1 - fresnel_transmittance(c, coat.eta); });
}

double rough_reflectance(double cosine, double alpha, const OpticalSurface& surface) {
  const Coat& coat = surface.coat;
  const double bare = surface.eta == 1.0 ? 0 : mean_reflectance(cosine, alpha, [&](double c) {
    return 1 - fresnel_transmittance(c, surface.eta);
  });
  if (coat.share == 0) return bare;
  const OpticalSurface whole(surface.eta, {.share = 1, .eta = coat.eta});
  const double below = mean_reflectance(cosine, std::min(alpha * coat.eta, 1.0), [&](double c) {
    return std::max(fresnel_transmittance(c, coat.eta) - fresnel_transmittance(c, whole), 0.0);
  });
  return (1 - coat.share) * bare + coat_reflectance(cosine, surface) + coat.share * below;
}

}  // namespace quadgraph
