// The walk of the buried source: closed forms along rays, refraction and reflection, conservation of power.
#include "engine/graph/fresnel.h"
#include "tests/cpp/walk_fixtures.h"

using namespace quadgraph;

namespace {

constexpr float mean_free_paths[] = {0.01f, 0.1f, 1.0f, 10.0f, 100.0f};

// Integral of sigma e^(-sigma t) against the hat function of plane i over planes `h` apart along the ray, from 0 to
// `count` h; with what passes `count` h left out.
double hat_integral(double sigma, double h, int i, int count) {
  const double tau = sigma * h;
  const double rest = std::exp(-tau * i);
  double sum = 0;
  // Falling side: (1 - s) for s in [0, 1] beyond plane i; rising side: s before it.
  if (i < count) sum += rest * (1 - (-std::expm1(-tau)) / tau);
  if (i > 0) sum += std::exp(-tau * (i - 1)) * ((-std::expm1(-tau)) / tau - std::exp(-tau));
  return sum;
}

std::vector<glm::dvec3> by_plane(const OwnedLevel& level, const std::vector<glm::dvec3>& deposit, double h, int count) {
  std::vector<glm::dvec3> planes(static_cast<std::size_t>(count) + 1, glm::dvec3(0));
  for (std::size_t v = 0; v < deposit.size(); ++v) {
    planes[static_cast<std::size_t>(std::lround(level.vertices[v].x / h))] += deposit[v];
  }
  return planes;
}

// Cosine inside of light that comes in along (cos, sin).
double refracted_cosine(double cos_i, double eta) {
  return std::sqrt(1 - (1 - cos_i * cos_i) / (eta * eta));
}

void check_balance(const WalkResult& result, double tolerance) {
  const glm::dvec3 deposited = total(result.deposit), left = total(result.unscattered);
  for (int c = 0; c < 3; ++c) {
    CAPTURE(c);
    CHECK(std::abs(result.balance()[c]) < tolerance);
    CHECK(deposited[c] == doctest::Approx(result.power.scattered[c]).epsilon(tolerance));
    CHECK(left[c] <= result.power.unscattered[c] * (1 + tolerance) + tolerance * result.entered[c]);
  }
}

}  // namespace

TEST_CASE("what rays scatter in a slab is the exact integral against the hat functions, at any angle") {
  CheckedContext device;
  constexpr int n = 6;
  constexpr double h = 0.5;
  const OwnedLevel level = slab_level(n, static_cast<float>(n * h));
  const glm::vec3 sigma_s_prime{1.0f, 0.3f, 0.05f}, sigma_a{0.2f, 0.0f, 0.4f};
  for (const float sine : {0.0f, 0.4f, 0.8f, 0.99f}) {
    const double cos_i = std::sqrt(1 - double{sine} * sine);
    const glm::vec3 direction(std::sqrt(1 - sine * sine), 0.6f * sine, 0.8f * sine);
    for (const double eta : {1.0, 1.4}) {
      CAPTURE(sine);
      CAPTURE(eta);
      const WalkResult result = walk(device.context, {.level = level,
                                                      .optical = uniform(sigma_s_prime, sigma_a),
                                                      .quarter_q = lit_side({-1, 0, 0}),
                                                      .beam = {gpu::BEAM_DIRECTIONAL, direction},
                                                      .eta = eta});
      check_balance(result, 1e-6);
      const double cosine = refracted_cosine(cos_i, eta), r = internal_reflectance(cosine, eta);
      const auto planes = by_plane(level, result.deposit, h, n);
      for (int c = 0; c < 3; ++c) {
        const double sigma = double{sigma_s_prime[c]} + sigma_a[c], albedo = sigma_s_prime[c] / sigma;
        const double through = std::exp(-sigma * n * h / cosine);
        for (int i = 0; i <= n; ++i) {
          // Forth and back between the two faces for ever: a geometric series.
          const double forth = hat_integral(sigma / cosine, h, i, n), back = hat_integral(sigma / cosine, h, n - i, n);
          const double pass = r * through;
          const double expected = albedo * (forth + pass * back) / (1 - pass * pass);
          CAPTURE(i);
          const double found = planes[static_cast<std::size_t>(i)][c] / result.entered[c];
          // Without reflection the ray is followed to the far side; with it, to the last thousandth.
          CHECK(std::abs(found - expected) < (eta == 1.0 ? 2e-6 : double{gpu::WALK_END}));
        }
      }
    }
  }
}
