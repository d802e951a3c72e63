// Names, overrides and error messages of materials.
#include <doctest/doctest.h>

#include "engine/graph/error.h"
#include "engine/graph/material.h"

using namespace quadgraph;

TEST_CASE("every listed material parses and is in range") {
  REQUIRE(material_names().size() == 13);
  for (const std::string& name : material_names()) CHECK_NOTHROW(check_material(parse_material(name)));
  const gpu::Material marble = parse_material("marble");
  CHECK(marble.sigma_s_prime.x == doctest::Approx(2.19));
  CHECK(marble.sigma_a.z == doctest::Approx(0.0071));
  CHECK(marble.eta == doctest::Approx(1.5));
}

TEST_CASE("coefficients are given as one value or per channel, alone or over a name") {
  const gpu::Material own = parse_material("sigma_s_prime=2.0,sigma_a=0.01/0.02/0.03,eta=1.4");
  CHECK(own.sigma_s_prime == glm::vec3(2.0f));
  CHECK(own.sigma_a == glm::vec3(0.01f, 0.02f, 0.03f));
  CHECK(own.eta == doctest::Approx(1.4));
  CHECK(parse_material("sigma_s_prime=1,sigma_a=0").eta == doctest::Approx(1.3));
  CHECK(parse_material("wholemilk,sigma_a=0").sigma_a == glm::vec3(0));
  CHECK(parse_material("marble-veins,vein_period=7").vein_period == doctest::Approx(7));
}

TEST_CASE("what is wrong is named with what is allowed") {
  const auto says = [](const char* text, const char* part) {
    CHECK_THROWS_WITH_AS(parse_material(text), doctest::Contains(part), InputError);
  };
  says("granite", "wholemilk");
  says("sigma_a=0.1", "sigma_s_prime");
  says("sigma_s_prime=1", "sigma_a");
  says("sigma_s_prime=0,sigma_a=0", "a number > 0");
  says("sigma_s_prime=1,sigma_a=-1", "a number >= 0");
  says("sigma_s_prime=1/2,sigma_a=0", "R/G/B");
  says("sigma_s_prime=nan,sigma_a=0", "finite");
  says("marble,eta=3.5", "1 to 3");
  says("marble,colour=red", "sigma_s_prime, sigma_a, eta");
  says("marble,eta=1.3,eta=1.4", "one value");
  says("marble,", "key=value");
}

TEST_CASE("a veined material varies in space, a homogeneous one does not") {
  const gpu::Material veined = parse_material("marble-veins");
  CHECK(veined.kind == gpu::MATERIAL_MARBLE_VEINS);
  CHECK(parse_material("marble").kind == gpu::MATERIAL_HOMOGENEOUS);
}
