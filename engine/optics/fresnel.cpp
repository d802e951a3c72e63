#include "engine/optics/fresnel.h"

#include <algorithm>
#include <cmath>
#include <glm/vec2.hpp>

namespace quadgraph {

namespace {

// A side of an interface: index of refraction over that outside, and the cosine of light there.
struct Side {
  double eta, cosine;
};

// From one side to the other, of both polarisations.
glm::dvec2 reflectances(const Side& from, const Side& into) {
  if (from.eta == into.eta) return glm::dvec2(0);  // the quotients below are 0/0 at grazing incidence
  const double parallel =
      (into.eta * from.cosine - from.eta * into.cosine) / (into.eta * from.cosine + from.eta * into.cosine);
  const double across =
      (from.eta * from.cosine - into.eta * into.cosine) / (from.eta * from.cosine + into.eta * into.cosine);
  return {parallel * parallel, across * across};
}

// Of light that comes from outside at that cosine.
Side inside(double cos_i, double eta) {
  return {eta, std::sqrt(std::max(1.0 - (1.0 - cos_i * cos_i) / (eta * eta), 0.0))};
}

double bare_transmittance(double cos_i, double eta) {
  const glm::dvec2 reflected = reflectances({1, cos_i}, inside(cos_i, eta));
  return 1.0 - 0.5 * (reflected.x + reflected.y);
}

// Whatever goes to and fro in the coat comes out at last: (1 - R)(1 - S) / (1 - R S) of reflectances R and S.
double coated_transmittance(double cos_i, double eta, double coat_eta) {
  const Side coat = inside(cos_i, coat_eta);
  const glm::dvec2 above = reflectances({1, cos_i}, coat), below = reflectances(coat, inside(cos_i, eta));
  double sum = 0;
  for (int k = 0; k < 2; ++k) {
    const double lost = 1 - above[k] * below[k];
    sum += lost > 0 ? (1 - above[k]) * (1 - below[k]) / lost : 0;
  }
  return 0.5 * sum;
}

}  // namespace

double fresnel_transmittance(double cos_i, const OpticalSurface& surface) {
  const double bare = bare_transmittance(cos_i, surface.eta), share = surface.coat.share;
  if (share == 0) return bare;
  return (1 - share) * bare + share * coated_transmittance(cos_i, surface.eta, surface.coat.eta);
}

double internal_reflectance(double mu, const OpticalSurface& surface) {
  const double sine2_outside = surface.eta * surface.eta * (1.0 - mu * mu);
  if (sine2_outside >= 1.0) return 1.0;
  return 1.0 - fresnel_transmittance(std::sqrt(1.0 - sine2_outside), surface);
}

double internal_diffuse_reflectance(double eta) {
  if (eta <= 1.0) return 0.0;
  return -1.440 / (eta * eta) + 0.710 / eta + 0.668 + 0.0636 * eta;
}

double mismatch(double eta) {
  const double f_dr = internal_diffuse_reflectance(eta);
  return (1.0 + f_dr) / (1.0 - f_dr);
}

}  // namespace quadgraph
