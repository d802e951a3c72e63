// Which model is taken by itself, and what diffusion gets wrong.
#include "engine/optics/model.h"

#include <doctest/doctest.h>

#include "engine/optics/material.h"

using namespace quadgraph;

namespace {

Model automatic(const char* material) {
  const gpu::Material m = parse_material(material);
  return resolve_model(Model::automatic, Method::fem, Source::buried, least_albedo(m), m.eta);
}

}  // namespace

TEST_CASE("diffusion is taken where it is within 1%, SP3 elsewhere") {
  for (const char* name : {"marble", "wholemilk", "skimmilk", "cream", "spectralon"}) {
    CAPTURE(name);
    CHECK(automatic(name) == Model::diffusion);
  }
  for (const char* name : {"skin1", "skin2", "ketchup", "chicken1", "chicken2", "potato", "apple", "marble-veins"}) {
    CAPTURE(name);
    CHECK(automatic(name) == Model::sp3);
  }
  CHECK(resolve_model(Model::sp3, Method::fem, Source::buried, 1.0, 1.3) == Model::sp3);
  CHECK(resolve_model(Model::diffusion, Method::fem, Source::buried, 0.1, 1.3) == Model::diffusion);
}

TEST_CASE("the published baseline is diffusion, whatever the material") {
  CHECK(resolve_model(Model::automatic, Method::quadgraph_fdm, Source::diffuse, 0.1, 1.3) == Model::diffusion);
  CHECK(resolve_model(Model::automatic, Method::quadgraph_fdm, Source::buried, 0.1, 1.3) == Model::sp3);
  CHECK(resolve_model(Model::automatic, Method::fem, Source::diffuse, 0.1, 1.3) == Model::sp3);
  CHECK(resolve_model(Model::sp3, Method::quadgraph_fdm, Source::diffuse, 0.1, 1.3) == Model::sp3);
}

TEST_CASE("the error of diffusion grows as the albedo falls, without a break at 2/3") {
  // Below that the two reflectances cross, far under anything that matters.
  for (const double absorbed : {1e-6, 1e-5, 1e-4}) CHECK(diffusion_error(1 - absorbed, 1.3) < 1e-3);
  double before = 0;
  for (double absorbed = 1e-3; absorbed < 0.5; absorbed *= 1.5) {
    const double error = diffusion_error(1 - absorbed, 1.3);
    CHECK(error >= before);
    before = error;
  }
  CHECK(diffusion_error(1.0, 1.3) < 1e-3);
  CHECK(diffusion_error(2.0 / 3, 1.3) == doctest::Approx(diffusion_error(2.0 / 3 + 1e-4, 1.3)).epsilon(1e-3));
  CHECK(diffusion_error(0.0, 1.3) == 1.0);
}

TEST_CASE("half-spaces of docs/truth.md, \"Reference values\": diffusion is off by what it is there") {
  // Albedo .7, eta 1.3: Monte Carlo .125, buried diffusion .136; SP3 is within 1% of Monte Carlo.
  CHECK(diffusion_error(0.7, 1.3) > 0.08);
  CHECK(diffusion_error(0.98, 1.3) < 0.03);
}

TEST_CASE("a clear region or a vein decides") {
  const std::vector<gpu::Optical> optical = {{glm::vec3(2), glm::vec3(0.001f)}, {glm::vec3(0), glm::vec3(0)}};
  CHECK(least_albedo(optical) == 0.0);
  CHECK(least_albedo(std::span(optical).first(1)) == doctest::Approx(2 / 2.001));
  CHECK(least_albedo(parse_material("marble-veins")) == doctest::Approx(1.2 / 2.05).epsilon(1e-5));
}

TEST_CASE("channels that lie far apart are not packed") {
  const auto rounding = [](const char* text, float spacing) { return packed_rounding(parse_material(text), spacing); };
  CHECK(rounding("sigma_s_prime=2,sigma_a=0.01", 1) == glm::vec2(1));
  CHECK(rounding("sigma_s_prime=1/1/20,sigma_a=0.05/0.05/1", 1e-3f).x > 1);
  CHECK(rounding("sigma_s_prime=1/1/20,sigma_a=0.05/0.05/1", 1e3f).x > 1);
  // On elements in which one channel is absorbed and another not.
  CHECK(rounding("sigma_s_prime=1/1/1,sigma_a=0.01/0.01/1", 1) == glm::vec2(1));
  CHECK(rounding("sigma_s_prime=1/1/1,sigma_a=0.01/0.01/1", 3).y > 1);
  for (const std::string& name : material_names()) {
    CAPTURE(name);
    CHECK(packed_rounding(parse_material(name), 0.5f) == glm::vec2(1));
  }
}
