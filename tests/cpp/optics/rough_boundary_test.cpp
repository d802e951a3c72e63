#include "engine/optics/rough_boundary.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "engine/optics/fresnel.h"

namespace quadgraph {
namespace {

double smith_lambda(double cosine, double alpha) {
  return 0.5 * (std::sqrt(1 + alpha * alpha * (1 - cosine * cosine) / (cosine * cosine)) - 1);
}

// Walter et al. 2007, over all facets by their slopes, not by what is seen of them.
double integrated(double cosine, double alpha, double eta) {
  constexpr int steps = 400;
  const double sine = std::sqrt(1 - cosine * cosine);
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double square = (i + 0.5) / steps, tilt = std::atan(alpha * std::sqrt(square / (1 - square)));
    for (int j = 0; j < steps; ++j) {
      const double turn = 2 * std::numbers::pi * (j + 0.5) / steps;
      const double seen = sine * std::sin(tilt) * std::cos(turn) + cosine * std::cos(tilt);
      const double leaves = 2 * seen * std::cos(tilt) - cosine;
      if (seen <= 0 || leaves <= 0) continue;
      const double shadowed = 1 / (1 + smith_lambda(cosine, alpha) + smith_lambda(std::min(leaves, 1.0), alpha));
      sum += (1 - fresnel_transmittance(std::min(seen, 1.0), eta)) * shadowed * seen / (cosine * std::cos(tilt));
    }
  }
  return sum / (steps * steps);
}

TEST_CASE("what a rough surface reflects is the integral over its facets") {
  for (const double alpha : {0.1, 0.3, 0.8}) {
    for (const double cosine : {1.0, 0.6, 0.2}) {
      CHECK(std::abs(rough_reflectance(cosine, alpha, 1.4) - integrated(cosine, alpha, 1.4)) < 2e-3);
    }
  }
}

TEST_CASE("a surface without roughness reflects as Fresnel says, one without an index nothing") {
  CHECK(rough_reflectance(0.3, 0, 1.5) == 1 - fresnel_transmittance(0.3, 1.5));
  CHECK(std::abs(rough_reflectance(0.3, 0.001, 1.5) - (1 - fresnel_transmittance(0.3, 1.5))) < 1e-3);
  CHECK(rough_reflectance(0.3, 0.5, 1) == 0);
  CHECK(rough_reflectance(0, 0.02, 1.3) <= 1);
}

}  // namespace
}  // namespace quadgraph
