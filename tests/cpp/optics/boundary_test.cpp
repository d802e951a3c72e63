// Fresnel quantities and the boundary matrix.
#include "engine/optics/boundary.h"

#include <doctest/doctest.h>

#include <glm/glm.hpp>

#include "engine/optics/fresnel.h"
#include "engine/optics/surface_boundary.h"

using namespace quadgraph;

TEST_CASE("Fresnel: energy, limits and the published polynomial") {
  CHECK(fresnel_transmittance(0.7, 1.0) == doctest::Approx(1.0));
  CHECK(fresnel_transmittance(1.0, 1.5) == doctest::Approx(0.96));
  CHECK(fresnel_transmittance(0.0, 1.3) == doctest::Approx(0.0));
  CHECK(internal_diffuse_reflectance(1.0) == 0.0);
  CHECK(mismatch(1.3) == doctest::Approx(2.602).epsilon(1e-3));
}

TEST_CASE("reflectance from inside is that from outside along the refracted ray, and 1 beyond the critical angle") {
  for (const double eta : {1.1, 1.3, 3.0}) {
    for (const double outside : {0.05, 0.4, 0.9, 1.0}) {
      const double inside = std::sqrt(1 - (1 - outside * outside) / (eta * eta));
      CHECK(internal_reflectance(inside, eta) == doctest::Approx(1 - fresnel_transmittance(outside, eta)));
    }
    const double critical = std::sqrt(1 - 1 / (eta * eta));
    CHECK(internal_reflectance(0.999 * critical, eta) == 1.0);
    CHECK(internal_reflectance(0.0, eta) == 1.0);
  }
  CHECK(internal_reflectance(0.3, 1.0) == 0.0);
}

TEST_CASE("moments of the internal reflectance: reciprocity, and the numbers of docs/physics.md, \"Fresnel terms\"") {
  // Isotropic light from outside and from inside exchange the same power: eta^2 (1 - 2 R1) = the outside transmittance.
  for (const double eta : {1.05, 1.3, 1.5, 3.0}) {
    double outside = 0;
    constexpr int count = 200000;
    for (int i = 0; i < count; ++i) {
      const double mu = (i + 0.5) / count;
      outside += 2 * mu * fresnel_transmittance(mu, eta) / count;
    }
    CHECK(diffuse_transmittance(eta) == doctest::Approx(outside).epsilon(1e-6));
  }
  CHECK(2 * fresnel_moment(1, 1.3) == doctest::Approx(0.4445).epsilon(1e-3));
  CHECK(3 * fresnel_moment(2, 1.3) == doctest::Approx(0.3003).epsilon(1e-3));
  CHECK(fresnel_moment(4, 1.0) == 0.0);
}

TEST_CASE("diffusion: two-moment 1/(2A), and the published one for the published baseline alone") {
  const Boundary two_moment = boundary_of(Method::fem, Source::buried, Model::diffusion, 1.3);
  CHECK(1 / (2 * two_moment.k11) == doctest::Approx(2.341).epsilon(1e-3));
  CHECK(two_moment.source == 0.0);
  CHECK(two_moment.reflected == 0.0);
  const Boundary published = boundary_of(Method::quadgraph_fdm, Source::diffuse, Model::diffusion, 1.3);
  CHECK(1 / (2 * published.k11) == doctest::Approx(mismatch(1.3)));
  CHECK(published.source == doctest::Approx(4 / (1 - internal_diffuse_reflectance(1.3))));
  CHECK(published.reflected == doctest::Approx(1 / mismatch(1.3)));  // M = (phi - 2q) / (2A)
  const Boundary buried = boundary_of(Method::quadgraph_fdm, Source::buried, Model::diffusion, 1.3);
  CHECK(buried.k11 == doctest::Approx(two_moment.k11));
}

TEST_CASE("SP3: the matrix of docs/physics.md, \"Boundary matrix\", in (phi, phi2)") {
  // K of (phi1, phi2): [[.5, -.125], [-.125, .29167]] at eta = 1, and T^T K T with T = [[1, 2/3], [0, 1]].
  const Boundary matched = boundary_of(Method::fem, Source::buried, Model::sp3, 1.0);
  CHECK(matched.k11 == doctest::Approx(0.5));
  CHECK(matched.k12 == doctest::Approx(0.5 * 2 / 3 - 0.125));
  CHECK(matched.k22 == doctest::Approx(0.5 * 4 / 9 - 2 * 0.125 * 2 / 3 + 7.0 / 24));
  const Boundary glass = boundary_of(Method::fem, Source::buried, Model::sp3, 1.3);
  const double off = (0.08658 + 0.09051) / 2;
  CHECK(glass.k11 == doctest::Approx(0.25193).epsilon(1e-4));
  CHECK(glass.k12 == doctest::Approx(0.25193 * 2 / 3 + off).epsilon(1e-4));
  CHECK(glass.k22 == doctest::Approx(0.25193 * 4 / 9 + off * 4 / 3 + 0.05935).epsilon(1e-4));
}

TEST_CASE("the boundary matrix is positive definite for every index") {
  for (double eta = 1.0; eta <= 3.0; eta += 0.01) {
    const Boundary k = boundary_of(Method::fem, Source::buried, Model::sp3, eta);
    CHECK(k.k11 > 0);
    CHECK(k.k11 * k.k22 - k.k12 * k.k12 > 0);
  }
}

TEST_CASE("in both models uniform light in equilibrium leaves as it came") {
  for (Model model : {Model::diffusion, Model::sp3}) {
    for (const double eta : {1.0, 1.3, 2.0}) {
      const Boundary k = boundary_of(Method::fem, Source::diffuse, model, eta);
      CHECK(k.k11 * k.source - k.reflected == doctest::Approx(1.0));
    }
  }
}
