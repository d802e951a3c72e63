// The certificate: walks find all power where none is lost, what a solution is off by, and what contradicts it.
#include "engine/solve/certificate.h"

#include <cmath>

#include "engine/base/error.h"
#include "engine/devices/open_device.h"
#include "tests/cpp/fixtures/exchange_fixtures.h"
#include "tests/cpp/fixtures/solved_body.h"
#include "tests/cpp/fixtures/test_device.h"

using namespace quadgraph;

namespace {

// A certificate, after a correction of few samples; 0 seconds: of as many walks on any machine.
Certificate certified(Scene& scene, double seconds = 0) {
  const SolveOptions options{.correction = true, .sweeps = 1, .sweep_points = 2000, .certify = seconds};
  SolveReport report = scene.simulation.solve(options);
  scene.simulation.certify(options, report, {});
  return *report.certificate;
}

SolveReport stating(double error, const CertifiedPart& unlit) {
  SolveReport report;
  report.error = ErrorEstimate{.whole = error, .unlit = error, .dimmest = error};
  report.certificate.emplace().unlit = unlit;
  state_disagreement(report);
  return report;
}

}  // namespace

TEST_CASE("where nothing is absorbed, walks bring out all of the light, whatever the index") {
  for (const float eta : {1.0f, 1.4f}) {
    CAPTURE(eta);
    Scene scene({8, 4});
    gpu::Material material{};
    material.sigma_s_prime = {0.2f, 0.6f, 1.5f};
    material.sigma_a = glm::vec3(0);
    material.eta = eta;
    scene.simulation.set_material(material);
    scene.light([](const glm::vec3&) { return glm::vec3(1.0f, 0.8f, 0.6f); });
    const Certificate found = certified(scene);
    // The solution loses no power, to rounding, but its few rays leave more or less of it unscattered than all would.
    CHECK(std::abs(found.whole.power) < 0.004 + 6 * found.whole.power_noise);
    CHECK(found.whole.power_noise < 0.01);
    CHECK(found.given_up == 0);
    CHECK(found.walks > 1e4);
  }
}

TEST_CASE(
    "where nothing is absorbed, scattering forwards brings out all of the light, too, and the error knows of it") {
  Scene scene({8, 4});
  gpu::Material material{};
  material.sigma_s_prime = {0.2f, 0.6f, 1.5f};
  material.sigma_a = glm::vec3(0);
  material.eta = 1.3f;
  material.g = {0.9f, 0.6f, -0.5f};
  scene.simulation.set_material(material);
  scene.light([](const glm::vec3& normal) { return normal.z > 0.5f ? glm::vec3(1) : glm::vec3(0); });
  const SolveOptions options{.correction = true, .sweeps = 1, .sweep_points = 2000};
  CHECK(scene.simulation.certifies(options));
  CHECK_FALSE(scene.simulation.certifies({.correction = false}));
  SolveReport report = scene.simulation.solve(options);
  const double before = report.error->whole;
  scene.simulation.certify(options, report, {});
  const Certificate& found = *report.certificate;
  CHECK(std::abs(found.whole.power) < 0.004 + 6 * found.whole.power_noise);
  CHECK(found.whole.power_noise < 0.01);
  CHECK(found.given_up == 0);
  CHECK(report.phase_warning.empty());
  CHECK(std::hypot(before, report.phase_error->whole) == doctest::Approx(report.error->whole));
  CHECK(report.error->whole >= found.whole.error);
}

TEST_CASE("walks find the same power by any importance: the solution's own, one that is wrong by two, and none") {
  for (const float scattering : {0.02f, 2.0f}) {
    Scene scene({6, 3});
    gpu::Material material{};
    material.sigma_s_prime = scattering * glm::vec3(1, 0.5f, 2);
    material.sigma_a = scattering * glm::vec3(0.3f, 0.05f, 0.01f);
    material.eta = 1.3f;
    material.g = {0, 0.8f, -0.4f};
    scene.simulation.set_material(material);
    scene.light([](const glm::vec3& normal) { return normal.z > 0.5f ? glm::vec3(1) : glm::vec3(0); });
    const SolveOptions options{.correction = true, .sweeps = 1, .sweep_points = 2000};
    const SolveReport solved = scene.simulation.solve(options);
    const auto measured = [&](bool guided, std::span<const glm::vec3> importance) {
      SolveReport report = solved;
      SolveOptions by = options;
      by.guided_walks = guided;
      by.certify = guided && importance.empty() ? 0.3 : 0;  // only walks of so long are led by the solution's own
      scene.simulation.certify(by, report, {}, importance);
      return *report.certificate;
    };
    // Some steps of two from vertex to vertex, and of ten from one side to the other.
    std::vector<glm::vec3> wrong;
    for (const glm::vec3& vertex : scene.simulation.present_level().vertices) {
      wrong.push_back(glm::vec3(std::pow(10.0f, -vertex.z / 8)) *
                      glm::vec3(1.0f + static_cast<float>(wrong.size() % 2)));
    }
    const Certificate plain = measured(false, {}), misled = measured(true, wrong), own = measured(true, {});
    CHECK_FALSE(plain.guided);
    CHECK(misled.guided);
    CHECK(own.guided);
    CHECK(misled.whole.power_noise < 0.02);
    CHECK(misled.unlit.power_noise < 0.03);
    for (const Certificate& other : {misled, own}) {
      CAPTURE(scattering);
      CHECK(std::abs(other.whole.power - plain.whole.power) <
            6 * std::hypot(other.whole.power_noise, plain.whole.power_noise));
      CHECK(std::abs(other.unlit.power - plain.unlit.power) <
            6 * std::hypot(other.unlit.power_noise, plain.unlit.power_noise));
      CHECK(other.given_up == 0);
    }
  }
}

TEST_CASE("a mean cosine that is next to none scatters as none does") {
  const auto power_behind = [](float g) {
    Scene scene({8, 4});
    gpu::Material material{};
    material.sigma_s_prime = glm::vec3(0.5f);
    material.sigma_a = glm::vec3(0.5f);
    material.eta = 1;
    material.g = glm::vec3(g);
    scene.simulation.set_material(material);
    scene.light([](const glm::vec3& normal) { return normal.z > 0.5f ? glm::vec3(1) : glm::vec3(0); });
    return certified(scene).unlit;
  };
  const CertifiedPart small = power_behind(1e-7f), larger = power_behind(1e-3f);
  CHECK(larger.power_noise < 0.01);
  CHECK(std::abs(small.power - larger.power) < 0.002 + 5 * std::hypot(small.power_noise, larger.power_noise));
}

TEST_CASE("channels are walked by themselves, and one without light has no walks") {
  Scene scene({8, 4});
  gpu::Material material{};
  material.sigma_s_prime = {0.5f, 1.0f, 2.0f};
  material.sigma_a = {0.5f, 0.1f, 0.0f};
  material.eta = 1.3f;
  scene.simulation.set_material(material);
  scene.light([](const glm::vec3& normal) { return normal.z > 0.5f ? glm::vec3(1, 0, 2) : glm::vec3(0); });
  const Certificate found = certified(scene, 0.3);
  CHECK(found.whole.power_noise > 0);
  CHECK(std::abs(found.whole.power) < 0.02 + 6 * found.whole.power_noise);
  CHECK(found.unlit.power_noise > 0);
}

TEST_CASE("an error that is stated is contradicted by one that is larger beyond its noise, and by no other") {
  const CertifiedPart large{.power = 0.01, .power_noise = 0.002, .error = 0.05, .error_noise = 0.005};
  CHECK(stating(0.01, large).certificate->disagreement ==
        "random walks contradict the stated error: the unlit part by 5% where 1% is stated");
  CHECK(stating(0.04, large).certificate->disagreement.empty());
  const CertifiedPart noisy{.power = 0.01, .power_noise = 0.002, .error = 0.05, .error_noise = 0.02};
  CHECK(stating(0.01, noisy).certificate->disagreement.empty());
  const CertifiedPart shifted{.power = -0.03, .power_noise = 0.002, .error = 0.0, .error_noise = 0.02};
  CHECK(stating(0.01, shifted).certificate->disagreement ==
        "random walks contradict the stated error: the unlit part by 3% where 1% is stated");
  CHECK(stating(0.01, {}).certificate->disagreement.empty());
}

TEST_CASE("only what is corrected can be certified") {
  Scene scene({4});
  scene.simulation.set_material(veined());
  scene.light(one_side);
  CHECK_THROWS_AS(check_options({.certify = 1}), InputError);
  CHECK_THROWS_AS(check_options({.correction = true, .certify = -1}), InputError);
  CHECK_THROWS_AS(check_options({.method = Method::quadgraph_fv, .correction = true, .certify = 1}), InputError);
}
