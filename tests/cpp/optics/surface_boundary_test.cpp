#include "engine/optics/surface_boundary.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "engine/optics/fresnel.h"
#include "engine/optics/rough_boundary.h"

namespace quadgraph {
namespace {

OpticalSurface rough(double eta, float alpha, float coat = 0) {
  return {eta, {.share = coat, .eta = 1.33f}, alpha};
}

TEST_CASE("rough surfaces: in even light as much goes in as out, and no more than all at any cosine") {
  for (const double eta : {1.05, 1.3, 1.5, 3.0}) {
    for (const float alpha : {0.02f, 0.1f, 0.3f, 1.0f}) {
      for (const float coat : {0.0f, 0.6f}) {
        const OpticalSurface surface = rough(eta, alpha, coat);
        double outside = 0;
        constexpr int count = 4000;
        for (int i = 0; i < count; ++i) {
          const double mu = (i + 0.5) / count;
          outside += 2 * mu * surface_transmittance(mu, surface) / count;
        }
        CHECK(diffuse_transmittance(surface) == doctest::Approx(outside).epsilon(1e-4));
        CHECK(radiance_norm(surface) == doctest::Approx(std::numbers::pi * outside).epsilon(1e-4));
        const RoughBoundary boundary = rough_boundary(surface);
        CHECK(std::ranges::min(boundary) >= 0.0f);
        CHECK(std::ranges::max(boundary) <= 1.0f);
      }
    }
  }
}

TEST_CASE("a slightly rough surface is next to a smooth one") {
  for (const double eta : {1.3, 1.5}) {
    for (int n = 1; n <= 6; ++n) {
      CHECK(fresnel_moment(n, rough(eta, 0.02f)) == doctest::Approx(fresnel_moment(n, eta)).epsilon(0.02));
    }
    CHECK(diffuse_transmittance(rough(eta, 0.02f)) == doctest::Approx(diffuse_transmittance(eta)).epsilon(0.004));
    for (const double cosine : {0.2, 0.6, 1.0}) {
      CHECK(std::abs(surface_transmittance(cosine, rough(eta, 0.02f)) - fresnel_transmittance(cosine, eta)) < 0.006);
    }
  }
}

TEST_CASE("the rougher a surface is, the more of even light it lets in") {
  for (const double eta : {1.2, 1.4, 1.8}) {
    double before = diffuse_transmittance(eta);
    for (const float alpha : {0.1f, 0.3f, 0.6f, 1.0f}) {
      const double now = diffuse_transmittance(rough(eta, alpha));
      CHECK(now > before);
      before = now;
    }
    CHECK(before < 1);
  }
}

TEST_CASE("a surface that mirrors nothing is smooth however rough, and water takes roughness from what it covers") {
  CHECK_FALSE(rough(1, 0.5f).rough());
  CHECK(fresnel_moment(2, rough(1, 0.5f)) == 0);
  CHECK(surface_transmittance(0.3, rough(1, 0.5f)) == 1);
  CHECK(facet_roughness(rough(1.4, 0.5f)) == 0.5f);
  CHECK(facet_roughness(rough(1.4, 0.5f, 1)) < 0.15f);
  CHECK(facet_roughness(rough(1.4, 0, 1)) == 0);
}

}  // namespace
}  // namespace quadgraph
