#include "engine/optics/fresnel.h"

#include <algorithm>
#include <cmath>
#include <glm/vec2.hpp>
#include <map>
#include <tuple>

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

namespace {

double integrated_moment(int n, const OpticalSurface& surface) {
  const double eta = surface.eta, critical = std::sqrt(1.0 - 1.0 / (eta * eta));
  // R starts as a square root at the critical cosine: smooth in t, mu = critical + (1 - critical) t^2. Simpson's rule.
  constexpr int intervals = 1024;
  double sum = 0;
  for (int i = 0; i <= intervals; ++i) {
    const double t = static_cast<double>(i) / intervals;
    const double mu = critical + (1.0 - critical) * t * t;
    const double weight = i == 0 || i == intervals ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0);
    sum += weight * internal_reflectance(mu, surface) * std::pow(mu, n) * 2.0 * t;
  }
  return std::pow(critical, n + 1) / (n + 1) + (1.0 - critical) * sum / (3.0 * intervals);
}

}  // namespace

// Kept by surface and order: solves ask for those of their bodies over and over.
double fresnel_moment(int n, const OpticalSurface& surface) {
  const Coat& coat = surface.coat;
  if (surface.eta == 1.0 && coat.share == 0) return 0.0;
  constexpr std::size_t most_kept = 256;
  thread_local std::map<std::tuple<int, double, float, float>, double> kept;
  const std::tuple key(n, surface.eta, coat.share, coat.share == 0 ? 1 : coat.eta);
  const auto found = kept.find(key);
  if (found != kept.end()) return found->second;
  if (kept.size() == most_kept) kept.clear();
  return kept[key] = integrated_moment(n, surface);
}

double diffuse_transmittance(const OpticalSurface& surface) {
  return surface.eta * surface.eta * (1.0 - 2.0 * fresnel_moment(1, surface));
}

double radiance_norm(const OpticalSurface& surface) {
  constexpr int steps = 4096;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double cos_o = (i + 0.5) / steps;
    sum += fresnel_transmittance(cos_o, surface) * cos_o;
  }
  return 2 * std::numbers::pi * sum / steps;
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
