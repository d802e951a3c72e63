// The facade on a small file (a cube of 2 mm, two levels), without a display.
#include "engine/render/engine.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <glm/geometric.hpp>

#include "engine/base/error.h"
#include "engine/optics/fresnel.h"
#include "engine/optics/surface_boundary.h"
#include "engine/render/picture/tone_mapper.h"
#include "tests/cpp/fixtures/checked_engine.h"

using namespace quadgraph;

namespace {

double total(const std::vector<float>& values) {
  double sum = 0;
  for (const float value : values) sum += value;
  return sum;
}

}  // namespace

TEST_CASE("a lit cube takes in the light of its face on every level, without a display") {
  unsetenv("DISPLAY");
  unsetenv("WAYLAND_DISPLAY");
  CheckedEngine checked;
  Engine& engine = checked.engine;
  engine.set_material("sigma_s_prime=2,sigma_a=0.1,eta=1.4");
  engine.set_lights({parse_light("directional:0,0,-1:1/2/3")});
  const SolveReport report = engine.solve();
  const double transmitted = fresnel_transmittance(1, 1.4);
  for (int c = 0; c < 3; ++c) {
    CHECK(report.energy.entered[c] == doctest::Approx(4.0 * (c + 1) * transmitted).epsilon(1e-4));
  }
  const SurfaceField field = engine.surface_field();
  for (std::size_t f = 0; f < field.q.size(); ++f) {
    CHECK(field.q[f].x == doctest::Approx(field.normal[f].z > 0.5f ? transmitted : 0).epsilon(1e-4));
  }
  for (std::uint32_t level = 0; level < engine.graph().levels().size(); ++level) {
    const auto& faces = engine.graph().levels()[level].faces;
    const auto& vertices = engine.graph().levels()[level].vertices;
    const auto q = device::download<glm::vec3>(engine.device(), engine.simulation().level(level).q);
    double power = 0;
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const glm::vec3 a = vertices[faces[f].x];
      power += 0.5 * glm::length(glm::cross(vertices[faces[f].y] - a, vertices[faces[f].z] - a)) * q[f].y;
    }
    CHECK(power == doctest::Approx(8 * transmitted).epsilon(1e-4));
  }
}

TEST_CASE("irradiance follows light and material, and given irradiance replaces the lights") {
  CheckedEngine checked;
  Engine& engine = checked.engine;
  engine.set_material("sigma_s_prime=2,sigma_a=0.1,eta=1");
  engine.set_lights({parse_light("directional:0,0,-1:1")});
  CHECK(engine.solve().energy.entered.x == doctest::Approx(4).epsilon(1e-4));
  engine.set_material("sigma_s_prime=2,sigma_a=0.1,eta=1.5");
  CHECK(engine.solve().energy.entered.x == doctest::Approx(4 * fresnel_transmittance(1, 1.5)).epsilon(1e-4));
  engine.set_lights({});
  CHECK(engine.solve().energy.entered.x == 0);
  for (std::uint32_t level = 0; level < engine.graph().levels().size(); ++level) {
    engine.set_irradiance(level, std::vector<glm::vec3>(engine.graph().levels()[level].face_count(), glm::vec3(0.5f)));
  }
  CHECK(engine.solve().energy.entered.x == doctest::Approx(12).epsilon(1e-4));
}

TEST_CASE("ambient light enters everywhere, and as much of it as a smooth surface lets in") {
  CheckedEngine checked;
  Engine& engine = checked.engine;
  engine.set_material("sigma_s_prime=5/3/1,sigma_a=0.1,eta=1.4");
  engine.set_lights({parse_light("ambient:2"), parse_light("directional:0,0,-1:1")});
  const SolveReport report = engine.solve({.tolerance = 1e-6});
  const double entered = 2 * 24 * diffuse_transmittance(1.4) + 4 * fresnel_transmittance(1, 1.4);  // a cube of 2 mm
  for (int c = 0; c < 3; ++c) {
    CHECK(report.energy.entered[c] == doctest::Approx(entered).epsilon(1e-4));
    CHECK(std::abs(report.energy.balance()[c]) < 1e-5);
  }
  for (const glm::vec3& m : engine.surface_field().exitance) CHECK(std::min({m.x, m.y, m.z}) > 0);
  const Picture picture = engine.render({.azimuth = 180, .elevation = 0}, {.width = 32, .height = 32});
  CHECK(total(picture.specular) > 0);  // the directional light is behind: this is the sky in the surface
}

TEST_CASE("a picture shows what was solved, and says how it was made") {
  CheckedEngine checked;
  Engine& engine = checked.engine;
  // So dense that little light crosses the 2 mm unscattered: it would leave on the far side.
  const std::string material = "sigma_s_prime=3,sigma_a=0.05,eta=1.3";
  engine.set_material(material);
  engine.set_lights({parse_light("directional:0,0,-1:1")});
  engine.solve();
  const Picture lit = engine.render({.azimuth = 0, .elevation = 0}, {.width = 96, .height = 64, .roughness = 0.3f});
  const Picture dark = engine.render({.azimuth = 180, .elevation = 0}, {.width = 96, .height = 64, .roughness = 0.3f});
  REQUIRE(lit.width == 96);
  REQUIRE(lit.height == 64);
  REQUIRE(lit.scattered.size() == 96 * 64 * 3);
  CHECK(total(lit.alpha) > 500);
  CHECK(total(dark.alpha) == doctest::Approx(total(lit.alpha)).epsilon(0.02));
  CHECK(total(dark.scattered) > 0);
  CHECK(total(lit.scattered) > total(dark.scattered));
  CHECK(total(lit.specular) > 0);
  CHECK(total(dark.specular) == 0);

  const Metadata metadata = engine.metadata();
  const auto value = [&](const std::string& key) {
    const auto entry = std::find_if(metadata.begin(), metadata.end(), [&](const auto& m) { return m.first == key; });
    REQUIRE_MESSAGE(entry != metadata.end(), key);
    return entry->second;
  };
  CHECK(value("material") == material);
  CHECK(value("lights") == "directional:0,0,-1:1");
  CHECK(value("method") == "fem");
  CHECK(value("solver") == "fmg-pcg");
  CHECK(value("tolerance") == "0.001");
  CHECK(value("units") == "W/(mm^2 sr)");
  CHECK(value("source") == "tiny.qgraph");
  CHECK(value("camera").find("view 180,0") == 0);
  CHECK(value("radiance") == "gathered");
  for (const char* key : {"device", "energy balance", "error", "iterations", "residual"}) CHECK(!value(key).empty());

  const auto passes = engine.passes();
  for (const char* name : {"shadow maps", "irradiance", "uncollided", "gathered exitance", "visibility", "gather"}) {
    const auto pass = std::find_if(passes.begin(), passes.end(), [&](const auto& p) { return p.name == name; });
    REQUIRE_MESSAGE(pass != passes.end(), name);
    CHECK(pass->time_ms > 0);
    CHECK(pass->bytes > 0);
  }
  const std::uint64_t before = engine.device_bytes();
  CHECK(before > 0);
  engine.render({}, {.width = 384, .height = 256});
  CHECK(engine.device_bytes() > before);
  CHECK(engine.peak_device_bytes() >= engine.device_bytes());
}

TEST_CASE("calls out of order and options out of range are refused") {
  CheckedEngine checked;
  Engine& engine = checked.engine;
  CHECK_THROWS_WITH_AS(engine.update_irradiance(), doctest::Contains("material"), InputError);
  CHECK_THROWS_WITH_AS(engine.render({}), doctest::Contains("solve first"), InputError);
  CHECK_THROWS_AS(engine.set_material("jade?"), InputError);
  CHECK_THROWS_AS(engine.set_lights({{.direction = {0, 0, 2}}}), InputError);
  engine.set_material("marble");
  engine.set_lights({parse_light("directional:0,0,-1:1")});
  engine.solve();
  CHECK_THROWS_WITH_AS(engine.render({}, {.width = 0}), doctest::Contains("0x1024"), InputError);
  CHECK_THROWS_WITH_AS(engine.render({}, {.width = 20000}), doctest::Contains("16384"), InputError);
  CHECK_THROWS_WITH_AS(engine.render({}, {.roughness = 0}), doctest::Contains("roughness"), InputError);
  CHECK_THROWS_AS(engine.render({.elevation = 120}), InputError);
}

TEST_CASE("a file that is not there is named") {
  CHECK_THROWS_WITH_AS(Engine("/no/such/file.qgraph"), doctest::Contains("/no/such/file.qgraph"), InputError);
}

TEST_CASE("pictures that follow each other allocate nothing, smaller ones neither") {
  CheckedEngine checked;
  Engine& engine = checked.engine;
  engine.set_material("sigma_s_prime=2,sigma_a=0.1,eta=1.4");
  engine.set_lights({parse_light("directional:0,0,-1:1")});
  engine.solve();
  ToneMapper mapper(engine.device());
  const auto show = [&](float azimuth, std::uint32_t width, std::uint32_t height) {
    const PictureBuffers& picture = engine.draw({.azimuth = azimuth}, {.width = width, .height = height});
    mapper.run(picture, {}, mapper.exposure(picture, {}), {120, 90});
  };
  show(0, 120, 90);
  const std::uint64_t allocations = engine.allocation_count(), bytes = engine.device_bytes();
  for (int i = 1; i < 6; ++i) show(20.0f * static_cast<float>(i), 120 / static_cast<std::uint32_t>(i), 90);
  CHECK(engine.allocation_count() == allocations);
  CHECK(engine.device_bytes() == bytes);
}

TEST_CASE("a body stands on its ground: at its foot a shadow and light of its own, none above, none from below") {
  for (const UpAxis up : {UpAxis::y, UpAxis::z}) {
    CheckedEngine checked;
    Engine& engine = checked.engine;
    engine.set_material("sigma_s_prime=2,sigma_a=0.1,eta=1.4");
    engine.set_lights({parse_light("directional:0,0,-1:1")});
    engine.solve();
    const View view{.azimuth = 0, .elevation = 12, .up = up};
    const Picture plain = engine.render(view, {.width = 90, .height = 90});
    const Picture standing = engine.render(view, {.width = 90, .height = 90, .ground = true});
    for (std::size_t i = 0; i < plain.alpha.size(); ++i) {
      if (plain.alpha[i] == 1) CHECK(standing.scattered[3 * i] == plain.scattered[3 * i]);
      CHECK(standing.scattered[3 * i] >= plain.scattered[3 * i]);
      CHECK(standing.alpha[i] <= 1);
    }
    std::size_t foot = 89;  // the lowest row that shows the body, in the middle
    while (plain.alpha[foot * 90 + 45] < 1) --foot;
    CHECK(standing.alpha[(foot + 2) * 90 + 45] > 0.1f);
    CHECK(standing.alpha[(foot + 2) * 90 + 45] < 1);
    CHECK(standing.scattered[3 * ((foot + 2) * 90 + 45)] > 0);
    CHECK(standing.alpha[5 * 90 + 45] == plain.alpha[5 * 90 + 45]);
    const View below{.azimuth = 0, .elevation = -50, .up = up};
    CHECK(engine.render(below, {.width = 90, .height = 90, .ground = true}).alpha ==
          engine.render(below, {.width = 90, .height = 90}).alpha);
  }
}

TEST_CASE("a picked point lies on the surface under the pointer, and at rest where it came from") {
  CheckedEngine checked;
  Engine& engine = checked.engine;
  const View front{.azimuth = 0, .elevation = 0};
  const auto middle = engine.pick(front, 1, {0, 0});
  REQUIRE(middle);
  CHECK(glm::distance(middle->position, glm::vec3(1, 1, 2)) < 1e-5f);
  CHECK(glm::distance(middle->at_rest, middle->position) < 1e-5f);
  CHECK(middle->normal.z == doctest::Approx(1));
  const auto aside = engine.pick(front, 2, {0.25f, 0.5f});
  REQUIRE(aside);
  CHECK(aside->position.x - 1 == doctest::Approx(aside->position.y - 1));  // twice as wide as high
  CHECK(aside->position.x > 1.2f);
  CHECK(!engine.pick(front, 1, {0.99f, 0.99f}));
  Deformer away{.kind = DeformerKind::transform};
  away.degrees = 90;
  away.translate = {50, 0, 0};
  engine.set_deformation({&away, 1});
  const auto turned = engine.pick(front, 1, {0, 0});
  REQUIRE(turned);
  CHECK(glm::distance(turned->position, glm::vec3(51, 1, 2)) < 1e-4f);
  // What is in front was at the side x = 0: turned by 90 degrees about y, x goes to -z.
  CHECK(glm::distance(turned->at_rest, glm::vec3(0, 1, 1)) < 1e-4f);
}
