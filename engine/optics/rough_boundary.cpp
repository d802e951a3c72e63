#include "engine/optics/rough_boundary.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "engine/optics/fresnel.h"
#include "engine/optics/visible_facets.h"

namespace quadgraph {
namespace {

// Share of what a facet reflects along `way` that no other facet holds up on either side of it (height-correlated,
// Heitz 2014). What is held up goes in after all: what is mirrored and what comes through are all of the light.
float gone_for_good(const glm::vec3& way, const glm::vec3& facet, float alpha) {
  const float cosine = 2.0f * glm::dot(way, facet) * facet.z - way.z;  // of what is mirrored
  if (cosine <= 0.0f) return 0.0f;
  const float seen = 1.0f + gpu::smith_lambda(way.z, alpha);
  return seen / (seen + gpu::smith_lambda(std::min(cosine, 1.0f), alpha));
}

// Of facets that reflect so much of light by its cosine with them.
double mean_reflectance(double cosine, double alpha, const std::function<double(double)>& reflected) {
  if (alpha == 0.0) return reflected(cosine);
  const glm::vec3 way = way_at(cosine);
  const auto rough = static_cast<float>(alpha);
  return mean_over_facets<double>(way, rough, [&](const glm::vec3& facet) {
    const double seen = std::clamp(static_cast<double>(glm::dot(way, facet)), 0.0, 1.0);
    return reflected(seen) * static_cast<double>(gone_for_good(way, facet, rough));
  });
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
