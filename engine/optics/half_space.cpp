#include "engine/optics/half_space.h"

#include <algorithm>
#include <cmath>
#include <glm/mat2x2.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>

namespace quadgraph {
namespace {

// Two moments; diffusion is the first one beside a second that nothing drives.
struct Moments {
  glm::dmat2 conduction, mass, boundary;  // lengths in mean free paths
  glm::dmat2 modes;                       // in columns
  glm::dvec2 rates;                       // squared
};

Moments moments_of(double albedo, const Boundary& k, Model model) {
  if (model != Model::sp3) {
    return {glm::dmat2(1.0 / 3), glm::dmat2(1 - albedo, 0, 0, 1), glm::dmat2(k.k11, 0, 0, 1), glm::dmat2(1),
            glm::dvec2(3 * (1 - albedo), 3)};
  }
  Moments m{glm::dmat2(1, 2.0 / 3, 2.0 / 3, 55.0 / 63) * (1.0 / 3),
            glm::dmat2(1 - albedo, 0, 0, 5.0 / 9),
            glm::dmat2(k.k11, k.k12, k.k12, k.k22),
            {},
            {}};
  const glm::dmat2 n = glm::inverse(m.conduction) * m.mass;
  const double half_trace = (n[0][0] + n[1][1]) / 2, determinant = glm::determinant(n);
  const double larger = half_trace + std::sqrt(half_trace * half_trace - determinant);
  m.rates = {determinant / larger, larger};
  for (int i = 0; i < 2; ++i) m.modes[i] = glm::dvec2(n[1][0], m.rates[i] - n[0][0]);
  return m;
}

// M / q of -G u'' + M u = albedo e^-z in the first moment, G u'(0) = K u(0).
double exact_reflectance(const Moments& m, double albedo) {
  const glm::dvec2 particular = -(glm::inverse(m.conduction - m.mass) * glm::dvec2(albedo, 0));
  glm::dmat2 equations;
  for (int i = 0; i < 2; ++i) {
    equations[i] = m.boundary * m.modes[i] + std::sqrt(m.rates[i]) * (m.conduction * m.modes[i]);
  }
  const glm::dvec2 amount = glm::inverse(equations) * (-(m.boundary * particular + m.conduction * particular));
  return (m.boundary * (m.modes * amount + particular)).x;
}

// By what a mode of squared rate `rate` changes from layer to layer: the root mu, |mu| < 1, of
// (2 - s) + x (4 + s) = 0 with s = mu + 1 / mu and x = rate depth^2 / 6.
double layer_ratio(double rate, double depth) {
  const double x = rate * depth * depth / 6;
  if (x == 1) return 0;
  const double s = (2 + 4 * x) / (1 - x);
  return std::copysign(2 / (std::abs(s) + std::sqrt(std::max(0.0, s * s - 4))), s);
}

// Reflectance of a half-space cut into layers: the particular solution falls by e^-depth per layer, like the load.
double layered_reflectance(const Moments& m, double albedo, double depth) {
  const double once = std::exp(-depth), entered = -std::expm1(-depth);
  const glm::dmat2 beside = m.conduction * (-1 / depth) + m.mass * (depth / 6);
  const glm::dmat2 middle = m.conduction * (2 / depth) + m.mass * (4 * depth / 6);
  const glm::dmat2 first = m.conduction * (1 / depth) + m.mass * (depth / 3) + m.boundary;
  const glm::dmat2 row = middle * once + beside * (1 + once * once);
  const glm::dvec2 particular = glm::inverse(row) * glm::dvec2(albedo * entered * entered / depth, 0);
  const glm::dvec2 load(albedo * (1 - entered / depth), 0);
  glm::dmat2 equations;
  for (int i = 0; i < 2; ++i) {
    equations[i] = first * m.modes[i] + beside * m.modes[i] * layer_ratio(m.rates[i], depth);
  }
  const glm::dvec2 amount = glm::inverse(equations) * (load - first * particular - beside * particular * once);
  return (m.boundary * (m.modes * amount + particular)).x;
}

}  // namespace

LayeredHalfSpace layered_half_space(double albedo, const Boundary& boundary, double depth, Model model) {
  // Removable singularities: no decay at all, and one exactly like that of the source.
  albedo = std::min(albedo, 1 - 1e-9);
  if (std::abs(albedo - 2.0 / 3) < 1e-6) albedo += 2e-6;
  const Moments m = moments_of(std::max(albedo, 0.0), boundary, model);
  const double decay = std::sqrt(m.rates.x) * depth;
  if (albedo <= 0) return {0, 0, decay};
  return {layered_reflectance(m, albedo, depth), exact_reflectance(m, albedo), decay};
}

LayeredHalfSpace layered_half_space(double albedo, double eta, double depth, Model model) {
  return layered_half_space(albedo, boundary_of(Method::fem, Source::buried, model, eta), depth, model);
}

}  // namespace quadgraph
