// Materials: the measured table, the texts a user writes, and the vein field.
#include "engine/optics/material.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/optics/colour.h"
#include "engine/optics/fresnel.h"
#include "shaders/material/material.h"
#include "shaders/material/optics.h"

using namespace quadgraph;

namespace {

std::string refusal(const std::string& text) {
  try {
    parse_material(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

void check_refused(const std::string& text, const std::string& field) {
  const std::string said = refusal(text);
  INFO("'" << text << "': " << said);
  CHECK(said.find(field) != std::string::npos);
}

}  // namespace

TEST_CASE("every listed name parses, and refers to its row of Jensen et al. 2001") {
  CHECK(material_names().size() == 31);
  for (const std::string& name : material_names()) CHECK_NOTHROW(check_material(parse_material(name)));
  const gpu::Material marble = parse_material("marble");
  CHECK(marble.sigma_s_prime == glm::vec3(2.19f, 2.62f, 3.00f));
  CHECK(marble.sigma_a == glm::vec3(0.0021f, 0.0041f, 0.0071f));
  CHECK(marble.eta == 1.5f);
  CHECK(parse_material("ketchup").sigma_a == glm::vec3(0.061f, 0.97f, 1.45f));
  CHECK(parse_material("spectralon").sigma_a == glm::vec3(0));
}

TEST_CASE("what a surface is like comes with a name, or is said, and changes no coefficient") {
  CHECK_FALSE(stated_roughness("marble"));
  CHECK_FALSE(stated_roughness("sigma_s_prime=1,sigma_a=0"));
  CHECK_FALSE(stated_roughness("wax.npz,map=shell"));
  CHECK_FALSE(stated_roughness(""));
  CHECK(stated_roughness("marble,roughness=0.1") == 0.1f);
  CHECK(stated_roughness("porcelain").value() < default_roughness);
  CHECK(stated_roughness("soap,eta=1.5").value() > default_roughness);
  CHECK(stated_roughness("porcelain,roughness=0.5") == 0.5f);
  CHECK(parse_material("marble,roughness=0.1").sigma_a == parse_material("marble").sigma_a);
  CHECK(parse_material("milk").sigma_s_prime == parse_material("wholemilk").sigma_s_prime);
  for (const char* text : {"marble,roughness=0.01", "marble,roughness=1.1", "marble,roughness=dull",
                           "sigma_s_prime=1,sigma_a=0,roughness=nan"}) {
    check_refused(text, "roughness");
  }
}

TEST_CASE("coefficients are given for all channels or for each, and override a name") {
  const gpu::Material own = parse_material("sigma_s_prime=2.0,sigma_a=0.01/0.02/0.03");
  CHECK(own.sigma_s_prime == glm::vec3(2.0f));
  CHECK(own.sigma_a == glm::vec3(0.01f, 0.02f, 0.03f));
  CHECK(own.eta == 1.3f);
  CHECK(own.pattern == gpu::PATTERN_NONE);
  const gpu::Material changed = parse_material("marble,eta=1,sigma_a=0");
  CHECK(changed.sigma_s_prime == parse_material("marble").sigma_s_prime);
  CHECK(changed.sigma_a == glm::vec3(0));
  CHECK(changed.eta == 1.0f);
  const gpu::Material veins = parse_material("marble-veins,period=40,second_sigma_a=1/2/3");
  CHECK(veins.pattern == gpu::PATTERN_VEINS);
  CHECK(veins.period == 40.0f);
  CHECK(veins.second_sigma_a == glm::vec3(1, 2, 3));
  CHECK(veins.sigma_a == parse_material("marble").sigma_a);
}

TEST_CASE("a colour gives the coefficients of a body that shows it") {
  for (const double eta : {1.0, 1.3, 2.0}) {
    for (const double albedo : {0.02, 0.5, 0.9, 0.999, 0.99999}) {
      const double back = albedo_of(diffuse_reflectance(albedo, eta), eta);
      CHECK(1 - back == doctest::Approx(1 - albedo).epsilon(1e-6));
    }
  }
  CHECK(diffuse_reflectance(0.0, 1.3) == 0.0);
  CHECK(diffuse_reflectance(1.0, 1.0) == doctest::Approx(1).epsilon(1e-3));
  CHECK(diffuse_reflectance(1.0, 1.5) == doctest::Approx(0.96).epsilon(1e-3));  // all that gets in
  const gpu::Material jade = parse_material("reflectance=0.2/0.5/0.3,mean_free_path=2/1/0.5,eta=1.5");
  for (int c = 0; c < 3; ++c) {
    const glm::vec3 length(2, 1, 0.5f), colour(0.2f, 0.5f, 0.3f);
    const double sigma_t = static_cast<double>(jade.sigma_s_prime[c] + jade.sigma_a[c]);
    CHECK(1 / sigma_t == doctest::Approx(static_cast<double>(length[c])));
    const double albedo = static_cast<double>(jade.sigma_s_prime[c]) / sigma_t;
    CHECK(diffuse_reflectance(albedo, 1.5) == doctest::Approx(static_cast<double>(colour[c])).epsilon(1e-5));
  }
  CHECK(parse_material("reflectance=0,mean_free_path=1").sigma_s_prime == glm::vec3(0));
  CHECK(parse_material("marble-veins,reflectance=0.5,mean_free_path=1").pattern == gpu::PATTERN_VEINS);
  check_refused("reflectance=0.5", "mean_free_path");
  check_refused("mean_free_path=1", "reflectance");
  check_refused("reflectance=0.99,mean_free_path=1,eta=1.5", "0 to 0.9598");
  check_refused("reflectance=-0.1,mean_free_path=1", "reflectance");
  check_refused("marble,pattern=veins,second_reflectance=2,second_mean_free_path=1", "second_reflectance");
  check_refused("reflectance=0.5,mean_free_path=0", "mean_free_path");
  check_refused("reflectance=0.5,mean_free_path=1,sigma_a=0", "sigma_a");
  check_refused("reflectance=0.5,mean_free_path=1,eta=7", "eta");
}

TEST_CASE("scattering of a mean cosine is reduced by it, channel by channel") {
  const gpu::Material tissue = parse_material("sigma_s=20/10/5,g=0.9/0.8/-0.5,sigma_a=0.01");
  const glm::vec3 reduced(2, 2, 7.5f);
  for (int c = 0; c < 3; ++c) CHECK(tissue.sigma_s_prime[c] == doctest::Approx(reduced[c]));
  CHECK(tissue.sigma_a == glm::vec3(0.01f));
  const gpu::Material marble = parse_material("marble,sigma_s=8,g=0.5");
  CHECK(marble.sigma_s_prime == glm::vec3(4));
  CHECK(marble.sigma_a == parse_material("marble").sigma_a);
  CHECK(parse_material("marble,pattern=veins,second_sigma_s=4,second_g=0.75,second_sigma_a=1").second_sigma_s_prime ==
        glm::vec3(1));
  check_refused("sigma_s=20,sigma_a=0", "'g': found 'nothing'");
  check_refused("g=0.5,sigma_a=0", "'sigma_s_prime': found 'nothing'");
  check_refused("sigma_s=20,g=0.9", "'sigma_a': found 'nothing'");
  check_refused("sigma_s=20,g=1,sigma_a=0", "above -1 and below 1");
  check_refused("sigma_s=-1,g=0,sigma_a=0", "'sigma_s'");
  check_refused("sigma_s=20,g=0.9,sigma_s_prime=2,sigma_a=0", "none beside a sigma_s");
  check_refused("sigma_s=20,g=0.9,reflectance=0.5,mean_free_path=1", "none beside a reflectance");
  check_refused("marble,second_sigma_s=4,second_g=0", "one beside a pattern");
}

TEST_CASE("a material keeps the mean cosine by which it was reduced, and says where no walk can go by it") {
  CHECK(parse_material("sigma_s=20/10/5,g=0.9/0.8/-0.5,sigma_a=0.01").g == glm::vec3(0.9f, 0.8f, -0.5f));
  const gpu::Material skin = parse_material("skin1,g=0.8");
  const ScatteringAngles known = angles_of(skin), none = angles_of(parse_material("skin1"));
  CHECK(skin.sigma_s_prime == parse_material("skin1").sigma_s_prime);
  CHECK(known == ScatteringAngles{.g = glm::vec3(0.8f)});
  CHECK(none == ScatteringAngles{});
  CHECK(phase_warning(known, KnownAngles::measured).empty());
  CHECK(phase_warning(known, KnownAngles::reduced).find("sweeps know") != std::string::npos);
  CHECK(phase_warning(known, KnownAngles::swept).find("two moments") != std::string::npos);
  CHECK(phase_warning(none, KnownAngles::reduced).empty());
  const ScatteringAngles both = angles_of(parse_material("marble-veins,g=0.8,second_g=0.8"));
  CHECK(angles_of(std::vector{both, known}) == known);
  CHECK(angles_of(std::vector{none, none}) == none);
  for (const ScatteringAngles& different :
       {angles_of(parse_material("marble-veins,g=0.5")), angles_of(std::vector{known, none})}) {
    CHECK(different == ScatteringAngles{.same = false});
    CHECK(phase_warning(different, KnownAngles::measured).find("the same everywhere") != std::string::npos);
  }
  gpu::Material wrong = skin;
  wrong.g = glm::vec3(0, 1, 0);
  CHECK_THROWS_AS(check_material(wrong), InputError);
}

TEST_CASE("what cannot be a material is refused by the field") {
  check_refused("", "marble-veins");
  check_refused("granite", "granite");
  check_refused("sigma_a=0.1", "sigma_s_prime");
  check_refused("sigma_s_prime=1", "sigma_a");
  check_refused("sigma_s_prime=-1,sigma_a=0", "sigma_s_prime");
  CHECK(parse_material("sigma_s_prime=0,sigma_a=0").sigma_s_prime == glm::vec3(0));  // clear
  check_refused("sigma_s_prime=1,sigma_a=-0.1", "sigma_a");
  check_refused("sigma_s_prime=1/2,sigma_a=0", "sigma_s_prime");
  check_refused("sigma_s_prime=1,sigma_a=nan", "sigma_a");
  check_refused("sigma_s_prime=1e60,sigma_a=0", "sigma_s_prime");
  check_refused("sigma_s_prime=1e-60,sigma_a=0", "sigma_s_prime");
  check_refused("sigma_s_prime=1x,sigma_a=0", "1x");
  check_refused("marble,eta=0.9", "eta");
  check_refused("marble,eta=3.1", "eta");
  check_refused("marble,eta=1.3,eta=1.4", "eta");
  check_refused("marble,period=3", "one beside a pattern");
  check_refused("marble,pattern=stripes", "none, veins, clouds, bands, rings, spots, checker");
  check_refused("marble,pattern=veins", "second_sigma_s_prime");
  check_refused("marble,pattern=veins,second_reflectance=0.5", "second_mean_free_path");
  check_refused("marble-veins,period=0", "period");
  check_refused("marble-veins,sharpness=0.5", "sharpness");
  check_refused("marble,", "key=value");
  check_refused("marble,colour=red", "sigma_s_prime, sigma_a, or reflectance");
  check_refused("granite", "wholemilk");
}

TEST_CASE("who slips in a name is told what it may have been, and nobody else is") {
  const auto said = [](const char* text) -> std::string {
    try {
      parse_material(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const std::vector<std::pair<std::string, std::string>> slips = {
      {"jed", "jade"},    {"Marble", "marble"},       {"skin", "skin1"},           {"wodo", "wood"},
      {"gummi", "gummy"}, {"dark_skin", "dark-skin"}, {"whole-milk", "wholemilk"}, {"marble_vein", "marble-veins"}};
  for (const auto& slip : slips) {
    CAPTURE(slip.first);
    CHECK(said(slip.first.c_str()).find("did you mean '" + slip.second + "'?") != std::string::npos);
  }
  for (const char* found : {"gold", "xyz", "", "a", "marblemarblemarblemarblemarblemarblemarblemarble"}) {
    CAPTURE(found);
    CHECK(said(found).find("allowed are") != std::string::npos);
    CHECK(said(found).find("did you mean") == std::string::npos);
  }
}

TEST_CASE("patterns stay between the two materials, reach both, and are the same wherever they are evaluated") {
  for (const std::string name : {"marble-veins", "jade", "agate", "wax", "wood", "checker"}) {
    CAPTURE(name);
    const gpu::Material m = parse_material(name);
    CHECK(m.pattern != gpu::PATTERN_NONE);
    float least = 1, most = 0;
    double sum = 0;
    constexpr int count = 20000;
    for (int i = 0; i < count; ++i) {
      // Points of a cube of 100 mm that fill it evenly (the R3 sequence).
      const glm::dvec3 at = glm::fract(glm::dvec3(0.8191725134, 0.6710436067, 0.5497004779) * static_cast<double>(i));
      const float t = gpu::pattern_amount(m, glm::vec3(100.0 * at - 50.0), 0);
      least = std::min(least, t);
      most = std::max(most, t);
      sum += static_cast<double>(t);
    }
    CHECK(least >= 0.0f);
    CHECK(least < 0.1f);
    CHECK(most <= 1.0f);
    CHECK(most > 0.8f);
    CHECK(sum / count > 0.02);
    CHECK(sum / count < 0.8);
  }
  const gpu::Material checker =
      parse_material("marble,pattern=checker,second_sigma_s_prime=1,second_sigma_a=2,period=10");
  CHECK(gpu::material_at(checker, {1, 1, 1}, 0).sigma_a == checker.sigma_a);
  CHECK(gpu::material_at(checker, {11, 1, 1}, 0).sigma_a == glm::vec3(2));
  CHECK(gpu::material_at(checker, {11, -1, 1}, 0).sigma_a == checker.sigma_a);
}

TEST_CASE("layers change at their depth") {
  const gpu::Material m =
      parse_material("marble,pattern=layers,second_sigma_s_prime=1,second_sigma_a=2,period=3,sharpness=2");
  for (const glm::vec3 place : {glm::vec3(0), glm::vec3(7, -3, 100)}) {
    CHECK(gpu::material_at(m, place, 0).sigma_a == m.sigma_a);
    CHECK(gpu::material_at(m, place, 2.2f).sigma_a == m.sigma_a);
    CHECK(gpu::material_at(m, place, 3).sigma_a.x == doctest::Approx(0.5f * (m.sigma_a.x + 2)));
    CHECK(gpu::material_at(m, place, 3.8f).sigma_a == glm::vec3(2));
  }
}

TEST_CASE("veins stay between the two materials, reach both, and have no jumps") {
  const gpu::Material m = parse_material("marble-veins");
  float least = 1, most = 0, steepest = 0;
  glm::vec3 last(-50.0f);
  float before = gpu::pattern_amount(m, last, 0);
  const glm::vec3 step = glm::vec3(0.6f, 0.64f, 0.48f) * 1e-3f;  // mm, through the lattice at a slant
  for (int i = 0; i < 200000; ++i) {
    last += step;
    const float t = gpu::pattern_amount(m, last, 0);
    steepest = std::max(steepest, std::abs(t - before));
    before = t;
    least = std::min(least, t);
    most = std::max(most, t);
  }
  CHECK(least >= 0.0f);
  CHECK(most <= 1.0f);
  CHECK(least < 0.01f);
  CHECK(most > 0.9f);
  // |t'| <= pi * sharpness / period * |phase'|, and |phase'| stays under 40 by the slopes of four octaves.
  CHECK(steepest < 40.0f * 3.1416f * m.sharpness / m.period * 1e-3f);
  const gpu::Optical optical = gpu::material_at(m, last, 0);
  const glm::vec3 low = glm::min(m.sigma_a, m.second_sigma_a), high = glm::max(m.sigma_a, m.second_sigma_a);
  CHECK(glm::all(glm::greaterThanEqual(optical.sigma_a, low)));
  CHECK(glm::all(glm::lessThanEqual(optical.sigma_a, high)));
}

TEST_CASE("a homogeneous material has kappa = 1 / (3 (sigma_a + sigma_s_prime)) everywhere") {
  const gpu::Material m = parse_material("sigma_s_prime=1.9,sigma_a=0.1");
  for (const float x : {-3.0f, 0.0f, 17.0f}) {
    CHECK(gpu::kappa(gpu::material_at(m, glm::vec3(x), 0)).y == doctest::Approx(1.0 / 6.0));
    CHECK(gpu::material_at(m, glm::vec3(x), 0).sigma_a == m.sigma_a);
  }
}

TEST_CASE("Fresnel transmittance is defined at grazing incidence and falls towards it") {
  CHECK(fresnel_transmittance(0.0, 1.0) == 1.0);
  for (const double eta : {1.0001, 1.3, 3.0}) {
    CHECK(fresnel_transmittance(0.0, eta) == doctest::Approx(0.0));
    double before = 0;
    for (int i = 1; i <= 100; ++i) {
      const double t = fresnel_transmittance(i / 100.0, eta);
      CHECK(t >= before);
      CHECK(t <= 1.0);
      before = t;
    }
  }
}
