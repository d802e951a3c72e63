// Light that scatters forwards, in sweeps: the phase function that they have, equilibrium, random walks of the whole
// one, motion, and that nothing of it is left behind.
#include "engine/solve/forward_scattering.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "tests/cpp/fixtures/exchange_fixtures.h"
#include "tests/cpp/fixtures/solved_body.h"
#include "tests/cpp/fixtures/test_device.h"

using namespace quadgraph;

namespace {

gpu::Material forwards(const glm::vec3& g, float sigma_a = 0.2f) {
  gpu::Material material{};
  material.sigma_s_prime = {0.3f, 0.5f, 1.0f};
  material.sigma_a = glm::vec3(sigma_a);
  material.eta = 1.3f;
  material.g = g;
  return material;
}

SolveOptions swept(std::uint32_t sweeps, bool warm = false) {
  return {.tolerance = 1e-5, .warm = warm, .correction = true, .sweeps = sweeps, .sweep_points = 5000};
}

// Means over the sphere of a function of the cosine, and of that times the cosine.
template <typename Function>
glm::dvec2 moments(const Function& function) {
  glm::dvec2 sum(0);
  constexpr int steps = 20000;
  for (int i = 0; i < steps; ++i) {
    const double cosine = (2 * i + 1.0) / steps - 1, value = function(cosine) / steps;
    sum += glm::dvec2(value, cosine * value);
  }
  return sum;
}

double henyey(double g, double cosine) {
  return (1 - g * g) / std::pow(1 + g * g - 2 * g * cosine, 1.5);
}

// W that leave, scattered or not, from faces that light enters and from the others.
glm::dvec2 leaving(const SurfaceField& field) {
  glm::dvec2 sum(0);
  for (std::size_t f = 0; f < field.area.size(); ++f) {
    const glm::vec3 all = field.area[f] * (field.exitance[f] + field.unscattered[f]);
    sum[field.q[f] == glm::vec3(0) ? 1 : 0] += double{all.x} + double{all.y} + double{all.z};
  }
  return sum;
}

}  // namespace

TEST_CASE("what is beyond linear adds neither light nor flux, and leaves no direction with less than next to nothing") {
  for (const float g : {0.02f, 0.3f, 0.6f, 0.8f, 0.9f, 0.97f}) {
    CAPTURE(g);
    const gpu::BesidePeak beside = beside_peak_of(glm::vec3(g));
    const double c = g / (1 + double{g});
    CHECK(double{gpu::cosine_beside_peak(beside.g).x} == doctest::Approx(c).epsilon(1e-4));
    const auto beyond = [&](double cosine) {
      return double{gpu::beyond_linear(beside, glm::vec3(static_cast<float>(cosine))).x};
    };
    const glm::dvec2 found = moments(beyond);
    CHECK(std::abs(found.x) < 2e-4);
    CHECK(std::abs(found.y) < 2e-4);
    double least = 1;
    for (int i = -100; i <= 100; ++i) least = std::min(least, 1 + 3 * c * 0.01 * i + beyond(0.01 * i));
    CHECK(least > -0.02);
    CHECK(1 - 3 * c + beyond(-1) < 1);
  }
}

TEST_CASE("light that scatters backwards has its own phase function") {
  const gpu::BesidePeak beside = beside_peak_of(glm::vec3(-0.5f));
  CHECK(gpu::beside_peak(beside.g).x == doctest::Approx(1 / 1.5));
  for (const double cosine : {-1.0, -0.4, 0.3, 1.0}) {
    const double beyond = double{gpu::beyond_linear(beside, glm::vec3(static_cast<float>(cosine))).x};
    CHECK(1 - 1.5 * cosine + beyond == doctest::Approx(henyey(-0.5, cosine)).epsilon(1e-4));
  }
}

TEST_CASE("where nothing is absorbed, light from everywhere leaves every side as it came, however it scatters") {
  for (const glm::vec3& g : {glm::vec3(0.9f), glm::vec3(0.5f, 0, -0.5f)}) {
    CAPTURE(g.x);
    Scene scene({6, 3});
    scene.simulation.set_material(forwards(g, 0));
    scene.light([](const glm::vec3&) { return glm::vec3(1); });
    const SolveReport report = scene.simulation.solve(swept(2));
    const SurfaceField field = scene.simulation.surface_field();
    std::map<std::tuple<long, long, long>, glm::dvec2> sides;  // area and power by normal
    for (std::size_t f = 0; f < field.area.size(); ++f) {
      const glm::vec3& n = field.normal[f];
      const glm::vec3 all = field.exitance[f] + field.unscattered[f];
      const double power = double{field.area[f]} * (double{all.x} + double{all.y} + double{all.z}) / 3;
      sides[{std::lround(n.x), std::lround(n.y), std::lround(n.z)}] += glm::dvec2(double{field.area[f]}, power);
    }
    for (const auto& [normal, side] : sides) CHECK(std::abs(side.y / side.x - 1) < 0.02);
    CHECK(std::abs(report.energy.balance().x) < 0.005);
  }
}

TEST_CASE("what leaves is that of random walks with the whole phase function, which the reduced coefficient misses") {
  Scene scene({8, 4});
  scene.light(one_side);
  scene.simulation.set_material(forwards(glm::vec3(0)));
  scene.simulation.solve(swept(3));
  const glm::dvec2 reduced = leaving(scene.simulation.surface_field());
  for (const float g : {0.5f, 0.9f}) {
    CAPTURE(g);
    scene.simulation.set_material(forwards(glm::vec3(g)));
    SolveReport report = scene.simulation.solve(swept(3));
    const glm::dvec2 known = leaving(scene.simulation.surface_field());
    scene.simulation.certify(swept(3), report, {});
    const Certificate& found = *report.certificate;
    const double unlit = known.y / (1 + found.unlit.power), missed = std::abs(reduced.y / unlit - 1);
    CHECK(found.whole.power_noise + found.unlit.power_noise < 0.01);
    CHECK(missed > 0.08);
    CHECK(std::abs(found.unlit.power) < 0.35 * missed + 5 * found.unlit.power_noise);
    CHECK(std::abs(found.whole.power) < 0.03 + 5 * found.whole.power_noise);
  }
}

TEST_CASE("in motion what goes forwards follows the light, without what sweeps know of it before") {
  Scene scene({8, 4});
  scene.simulation.set_material(forwards(glm::vec3(0.8f)));
  const auto light = [&](float share) {
    scene.light([&](const glm::vec3& p) {
      return (1 - share) * one_side(p) + (p.y < 1e-4f ? glm::vec3(share) : glm::vec3(0));
    });
  };
  light(0);
  scene.simulation.solve(swept(1));
  for (int k = 1; k <= 10; ++k) {
    light(0.1f * static_cast<float>(k));
    scene.simulation.solve(swept(1, true));
  }
  const glm::dvec2 moving = leaving(scene.simulation.surface_field());
  scene.simulation.solve(swept(3));
  const glm::dvec2 rest = leaving(scene.simulation.surface_field());
  CHECK(std::abs(moving.x / rest.x - 1) < 0.03);
  CHECK(std::abs(moving.y / rest.y - 1) < 0.03);
}

TEST_CASE("a material without g is what it was, to the bit, once one with it has been there") {
  Scene scene({6, 3});
  scene.light(one_side);
  const auto exitance = [&](const glm::vec3& g) {
    scene.simulation.set_material(forwards(g));
    scene.simulation.solve(swept(2));
    return scene.simulation.surface_field().exitance;
  };
  const std::vector<glm::vec3> before = exitance(glm::vec3(0)), between = exitance(glm::vec3(0.7f));
  CHECK(relative_difference(before, between) > 0.02);
  CHECK(exitance(glm::vec3(0)) == before);
  CHECK(exitance(glm::vec3(0.7f)) == between);
}
