#include "engine/optics/model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/mat2x2.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>

#include "engine/optics/boundary.h"
#include "shaders/material/optics.h"

namespace quadgraph {
namespace {

// A half-space lit at normal incidence, lengths in mean free paths.
struct HalfSpace {
  double reflectance;  // M / q
  double decay;        // of the slowest mode
};

// kappa phi'' = (1 - albedo) phi - albedo e^-z, kappa phi'(0) = k11 phi(0).
HalfSpace diffusion_half_space(double albedo, double k11) {
  constexpr double kappa = 1.0 / 3;
  const double decay = std::sqrt((1 - albedo) / kappa);
  const double particular = -albedo / (kappa - (1 - albedo));
  const double mode = -particular * (k11 + kappa) / (k11 + kappa * decay);
  return {k11 * (mode + particular), decay};
}

// The half-space in SP3, with its G and masses (operator.h): two modes and the particular solution.
HalfSpace sp3_half_space(double albedo, const Boundary& boundary) {
  const glm::dmat2 kappa = glm::dmat2(1, 2.0 / 3, 2.0 / 3, 55.0 / 63) * (1.0 / 3);
  const glm::dmat2 mass(1 - albedo, 0, 0, 5.0 / 9);
  const glm::dmat2 k(boundary.k11, boundary.k12, boundary.k12, boundary.k22);
  const glm::dvec2 particular = -(glm::inverse(kappa - mass) * glm::dvec2(albedo, 0));
  const glm::dmat2 n = glm::inverse(kappa) * mass;
  const double half_trace = (n[0][0] + n[1][1]) / 2;
  const double root = std::sqrt(half_trace * half_trace - glm::determinant(n));
  // The small eigenvalue by the product: their difference would lose it.
  const std::array<double, 2> squares = {glm::determinant(n) / (half_trace + root), half_trace + root};
  glm::dmat2 modes, equations;
  for (int i = 0; i < 2; ++i) {
    const double square = squares[static_cast<std::size_t>(i)];
    modes[i] = glm::dvec2(n[1][0], square - n[0][0]);
    equations[i] = k * modes[i] + std::sqrt(square) * (kappa * modes[i]);
  }
  const glm::dvec2 amount = glm::inverse(equations) * (-(k * particular + kappa * particular));
  return {(k * (modes * amount + particular)).x, std::sqrt(squares[0])};
}

double albedo_of(double sigma_s_prime, double sigma_a) {
  const double sigma_t = sigma_s_prime + sigma_a;
  return sigma_t > 0 ? sigma_s_prime / sigma_t : 0.0;
}

double least_albedo(const glm::vec3& sigma_s_prime, const glm::vec3& sigma_a) {
  double least = 1;
  for (int c = 0; c < 3; ++c) least = std::min(least, albedo_of(sigma_s_prime[c], sigma_a[c]));
  return least;
}

}  // namespace

double diffusion_error(double albedo, double eta) {
  if (albedo >= 1) albedo = 1 - 1e-9;                     // both models agree in the limit, where the decay vanishes
  if (std::abs(albedo - 2.0 / 3) < 1e-6) albedo += 2e-6;  // diffusion decays like the source: a removable singularity
  const Boundary sp3 = boundary_of(Method::fem, Source::buried, Model::sp3, eta);
  const Boundary diffusion = boundary_of(Method::fem, Source::buried, Model::diffusion, eta);
  if (albedo <= 0) return 1;
  const HalfSpace one = diffusion_half_space(albedo, diffusion.k11), two = sp3_half_space(albedo, sp3);
  return std::max(std::abs(one.reflectance / two.reflectance - 1), std::abs(one.decay / two.decay - 1));
}

double least_albedo(const gpu::Material& material) {
  const double base = least_albedo(material.sigma_s_prime, material.sigma_a);
  if (material.pattern == gpu::PATTERN_NONE) return base;
  return std::min(base, least_albedo(material.second_sigma_s_prime, material.second_sigma_a));
}

double least_albedo(std::span<const gpu::Optical> optical) {
  double least = 1;
  for (const gpu::Optical& o : optical) least = std::min(least, least_albedo(o.sigma_s_prime, o.sigma_a));
  return least;
}

glm::vec2 packed_rounding(const gpu::Material& material, float spacing) {
  const std::array<gpu::Optical, 2> sets = {
      {{material.sigma_s_prime, material.sigma_a}, {material.second_sigma_s_prime, material.second_sigma_a}}};
  return packed_rounding(std::span(sets).first(material.pattern == gpu::PATTERN_NONE ? 1 : 2), spacing);
}

glm::vec2 packed_rounding(std::span<const gpu::Optical> optical, float spacing) {
  glm::vec2 most(1);
  for (const gpu::Optical& o : optical) most = glm::max(most, gpu::packed_rounding(o, spacing));
  return most;
}

Model resolve_model(Model wanted, Method method, Source source, double albedo, double eta) {
  if (wanted != Model::automatic) return wanted;
  if (published(method) && source == Source::diffuse) return Model::diffusion;
  return diffusion_error(albedo, eta) <= model_tolerance ? Model::diffusion : Model::sp3;
}

}  // namespace quadgraph
