#include "engine/optics/fresnel.h"

#include <cmath>
#include <map>
#include <utility>

namespace quadgraph {

double fresnel_transmittance(double cos_i, double eta) {
  if (eta == 1.0) return 1.0;  // the quotients below are 0/0 at grazing incidence
  const double cos_t = std::sqrt(1.0 - (1.0 - cos_i * cos_i) / (eta * eta));
  const double parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
  const double perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
  return 1.0 - 0.5 * (parallel * parallel + perpendicular * perpendicular);
}

double internal_reflectance(double mu, double eta) {
  const double sine2_outside = eta * eta * (1.0 - mu * mu);
  if (sine2_outside >= 1.0) return 1.0;
  return 1.0 - fresnel_transmittance(std::sqrt(1.0 - sine2_outside), eta);
}

namespace {

double integrated_moment(int n, double eta) {
  const double critical = std::sqrt(1.0 - 1.0 / (eta * eta));
  // R starts as a square root at the critical cosine: smooth in t, mu = critical + (1 - critical) t^2. Simpson's rule.
  constexpr int intervals = 1024;
  double sum = 0;
  for (int i = 0; i <= intervals; ++i) {
    const double t = static_cast<double>(i) / intervals;
    const double mu = critical + (1.0 - critical) * t * t;
    const double weight = i == 0 || i == intervals ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0);
    sum += weight * internal_reflectance(mu, eta) * std::pow(mu, n) * 2.0 * t;
  }
  return std::pow(critical, n + 1) / (n + 1) + (1.0 - critical) * sum / (3.0 * intervals);
}

}  // namespace

// Kept by index and order: solves ask for those of their bodies over and over.
double fresnel_moment(int n, double eta) {
  if (eta == 1.0) return 0.0;
  constexpr std::size_t most_kept = 256;
  thread_local std::map<std::pair<int, double>, double> kept;
  const auto found = kept.find({n, eta});
  if (found != kept.end()) return found->second;
  if (kept.size() == most_kept) kept.clear();
  return kept[{n, eta}] = integrated_moment(n, eta);
}

double diffuse_transmittance(double eta) {
  return eta * eta * (1.0 - 2.0 * fresnel_moment(1, eta));
}

double radiance_norm(double eta) {
  constexpr int steps = 4096;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double cos_o = (i + 0.5) / steps;
    sum += fresnel_transmittance(cos_o, eta) * cos_o;
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
