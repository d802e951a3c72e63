// Clear layers on the surface of a body.
#include "engine/optics/coat.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <string>

#include "engine/base/error.h"
#include "engine/optics/fresnel.h"
#include "engine/optics/material.h"
#include "engine/optics/rough_boundary.h"
#include "engine/optics/surface_boundary.h"

namespace quadgraph {
namespace {

OpticalSurface coated(double eta, float coat_eta, float share = 1) {
  return {eta, {.share = share, .eta = coat_eta}};
}

// By Fresnel's equations with angles, of one polarisation: light from index a to b.
double reflected(double a, double b, double sine_outside, bool across) {
  const double in = std::asin(sine_outside / a), out = std::asin(sine_outside / b);
  if (in + out == 0) return std::pow((a - b) / (a + b), 2);
  const double found = across ? std::sin(in - out) / std::sin(in + out) : std::tan(in - out) / std::tan(in + out);
  return found * found;
}

// What goes in, bounce after bounce in the coat.
double let_in(double cosine, double eta, double coat_eta) {
  const double sine = std::sqrt(1 - cosine * cosine);
  double sum = 0;
  for (const bool across : {false, true}) {
    const double above = reflected(1, coat_eta, sine, across), below = reflected(coat_eta, eta, sine, across);
    double within = 1 - above;
    for (int bounce = 0; bounce < 200; ++bounce) {
      sum += 0.5 * within * (1 - below);
      within *= below * above;
    }
  }
  return sum;
}

TEST_CASE("what a coated surface lets in is the sum of what goes to and fro in the coat") {
  for (const double eta : {1.0, 1.3, 1.6}) {
    for (const float coat_eta : {1.333f, 1.5f, 2.5f}) {
      for (const double cosine : {0.999, 0.7, 0.3, 0.1}) {
        CHECK(fresnel_transmittance(cosine, coated(eta, coat_eta)) ==
              doctest::Approx(let_in(cosine, eta, double{coat_eta})).epsilon(1e-9));
      }
    }
  }
}

TEST_CASE("a coat of the index of what is above or below it changes nothing, half a coat half as much") {
  for (const double cosine : {1.0, 0.5, 0.05}) {
    const double bare = fresnel_transmittance(cosine, 1.5);
    CHECK(fresnel_transmittance(cosine, coated(1.5, 1.5f)) == doctest::Approx(bare));
    CHECK(fresnel_transmittance(cosine, coated(1.5, 1.0f)) == doctest::Approx(bare));
    CHECK(fresnel_transmittance(cosine, coated(1.5, 2.0f, 0)) == bare);
    const double whole = fresnel_transmittance(cosine, coated(1.5, 2.0f));
    CHECK(fresnel_transmittance(cosine, coated(1.5, 2.0f, 0.5f)) == doctest::Approx(0.5 * (bare + whole)));
  }
  CHECK(fresnel_transmittance(0, coated(1, 1.5f)) == doctest::Approx(0));
}

TEST_CASE("coated surfaces: light in and out by reciprocity, the critical angle as without") {
  for (const double eta : {1.0, 1.3, 1.6}) {
    const OpticalSurface surface = coated(eta, 1.8f, 0.7f);
    double outside = 0;
    constexpr int count = 200000;
    for (int i = 0; i < count; ++i) {
      const double mu = (i + 0.5) / count;
      outside += 2 * mu * fresnel_transmittance(mu, surface) / count;
    }
    CHECK(diffuse_transmittance(surface) == doctest::Approx(outside).epsilon(1e-5));
    const double critical = std::sqrt(1 - 1 / (eta * eta));
    if (eta > 1) CHECK(internal_reflectance(0.999 * critical, surface) == 1.0);
    CHECK(internal_reflectance(1, surface) == doctest::Approx(1 - fresnel_transmittance(1, surface)));
  }
  CHECK(fresnel_moment(1, coated(1, 1.5f)) > 0.01);
}

TEST_CASE("what a rough body reflects under a coat: of all the coat's own part, smooth ones as Fresnel says") {
  for (const double cosine : {1.0, 0.5}) {
    OpticalSurface surface = coated(1.4, 1.6f, 0.5f);
    surface.coat.roughness = 0.02f;
    const double whole = rough_reflectance(cosine, 0, surface);
    CHECK(std::abs(whole - (1 - fresnel_transmittance(cosine, surface))) < 1e-3);
    CHECK(std::abs(coat_reflectance(cosine, surface) - 0.5 * (1 - fresnel_transmittance(cosine, 1.6))) < 1e-3);
    CHECK(rough_reflectance(cosine, 0.4, surface) > coat_reflectance(cosine, surface));
    CHECK(coat_reflectance(cosine, 1.4) == 0);
  }
}

TEST_CASE("a coat is stated in a material's text") {
  const Coat water = stated_coat("jade,coat=water");
  CHECK(water.share == 1);
  CHECK(water.eta == doctest::Approx(1.333));
  CHECK(stated_coat("jade,coat_roughness=0.2,coat=water").roughness == doctest::Approx(0.2));
  const Coat own = stated_coat("sigma_s_prime=1,sigma_a=0.1,coat=0.4,coat_eta=1.7,coat_roughness=0.1");
  CHECK(own == Coat{.share = 0.4f, .eta = 1.7f, .roughness = 0.1f});
  CHECK(stated_coat("jade") == Coat{});
  CHECK(without_coat("jade,coat=0.4,roughness=0.2,coat_eta=1.7") == "jade,roughness=0.2");
  CHECK(stated_coat(with_coat("jade,coat=water", own)) == own);
  CHECK(with_coat("jade,coat=water", {}) == "jade");
  CHECK(parse_material("jade,coat=lacquer").eta == parse_material("jade").eta);
  for (const std::string bad : {"coat=wet", "coat=1.5", "coat_eta=0.9", "coat_roughness=0", "coat=nan"}) {
    CHECK_THROWS_AS(parse_material("jade," + bad), InputError);
  }
  CHECK_THROWS_WITH_AS(
      parse_material("jade,coat=wet"),
      "material field 'coat': found 'wet', allowed is water, lacquer, or a share of the surface from 0 "
      "to 1",
      InputError);
}

}  // namespace
}  // namespace quadgraph
