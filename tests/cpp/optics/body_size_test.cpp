// What materials look like on bodies of a size, and when that is said not to be what was meant.
#include "engine/optics/body_size.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "engine/optics/material.h"

using namespace quadgraph;

namespace {

double red(const std::string& text, double chord) {
  return body_colour(parse_material(text), chord).x;
}

std::string said_of(const std::string& text, double chord) {
  return size_warning(text, parse_material(text), chord);
}

// Mean chords of bunnies of 30, 80 and 300 mm.
constexpr double small = 10.3, middle = 27.3, large = 102.6;

}  // namespace

TEST_CASE("what a body sends back has the limits of two streams") {
  CHECK(red("sigma_s_prime=1,sigma_a=0", 30) == 1);
  CHECK(red("sigma_s_prime=0,sigma_a=0.02,eta=1", 30) == doctest::Approx(std::exp(-0.6)));
  CHECK(red("sigma_s_prime=1e-6,sigma_a=0.02,eta=1", 30) == doctest::Approx(std::exp(-0.6)).epsilon(1e-4));
  // Of any depth: 1 + K / S - sqrt((K / S)^2 + 2 K / S).
  const double ratio = 2 * 0.1 / 0.75;
  const double deep = 1 + ratio - std::sqrt(ratio * (ratio + 2));
  CHECK(red("sigma_s_prime=1,sigma_a=0.1,eta=1", 1e6) == doctest::Approx(deep).epsilon(1e-5));
  CHECK(red("sigma_s_prime=1,sigma_a=0.1,eta=1", 1e300) == doctest::Approx(deep).epsilon(1e-5));
  double before = 1;
  for (const char* absorption : {"0.001", "0.01", "0.1", "1"}) {
    const double now = red(std::string("sigma_s_prime=1,eta=1.4,sigma_a=") + absorption, 20);
    CHECK(now < before);
    before = now;
  }
  CHECK(red("sigma_s_prime=1,sigma_a=0.1", 20) ==
        doctest::Approx(red("sigma_s_prime=2,sigma_a=0.2", 10)).epsilon(1e-6));
}

TEST_CASE("on bunnies of 30, 80 and 300 mm names look as meant, but for honey of 300 mm") {
  std::set<std::string> warned;
  for (const std::string& name : material_names()) {
    CHECK(said_of(name, meant_chord).empty());
    for (const double chord : {small, middle, large}) {
      if (!said_of(name, chord).empty()) warned.insert(name + (chord == large ? ", large" : ""));
    }
  }
  CHECK(warned == std::set<std::string>{"honey, large"});
  const std::string said = said_of("honey", large);
  for (const char* words : {"honey: a body that light crosses in 103 mm on average", "3.8 times smaller", "sigma_a"}) {
    CAPTURE(said);
    CHECK(said.find(words) != std::string::npos);
  }
}

TEST_CASE("what helps helps") {
  CHECK_FALSE(said_of("honey", 3.8 * meant_chord).empty());
  CHECK(said_of("sigma_s_prime=0.01,sigma_a=0.1", 3.8 * meant_chord).empty());
  const std::string thin = said_of("reflectance=0.2/0.6/0.4,mean_free_path=40", 10);
  CAPTURE(thin);
  const auto at = thin.find("a mean_free_path ");
  REQUIRE(at != std::string::npos);
  const double factor = std::stod(thin.substr(at + 17));
  CHECK(factor > 1.2);
  CHECK(said_of("reflectance=0.2/0.6/0.4,mean_free_path=40", 1.05 * factor * 10).empty());
  CHECK(said_of("reflectance=0.2/0.6/0.4,mean_free_path=" + std::to_string(40 / (1.05 * factor)), 10).empty());
}

TEST_CASE("thin bodies are said to be clear, and texts that promise nothing are not judged") {
  CHECK(said_of("milk", 0.05).find("nearly clear") != std::string::npos);
  CHECK(said_of("milk", 1).empty());
  CHECK(said_of("gummy", 0.5).find("gummy: ") == 0);
  CHECK_FALSE(said_of("honey,eta=1.4,roughness=0.3", large).empty());
  for (const char* text : {"honey,sigma_a=0.003/0.025/0.25", "sigma_s_prime=0.03,sigma_a=0.003/0.025/0.25", "",
                           "wax.npz,map=shell", "coefficients per node, eta=1.3"}) {
    CAPTURE(text);
    CHECK(size_warning(text, {}, large).empty());
  }
  CHECK(said_of("honey", std::numeric_limits<double>::infinity()).empty());
  CHECK(said_of("honey", 0).empty());
}
