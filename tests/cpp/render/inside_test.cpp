// Views of the inside: their text, their cuts, their colours and what they show of a small body.
#include "engine/render/inside/inside.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>

#include "engine/base/error.h"
#include "engine/render/engine.h"
#include "engine/render/picture/legend.h"
#include "shaders/display/colour_map.h"
#include "tests/cpp/fixtures/test_data.h"
#include "tests/cpp/fixtures/test_device.h"

using namespace quadgraph;

namespace {

const std::filesystem::path cube = test_data("tiny.qgraph");

double area_of(const FalseMesh& mesh) {
  double sum = 0;
  for (std::size_t i = 0; i + 2 < mesh.size(); i += 3) {
    sum += 0.5 * static_cast<double>(glm::length(
                     glm::cross(mesh[i + 1].position - mesh[i].position, mesh[i + 2].position - mesh[i].position)));
  }
  return sum;
}

}  // namespace

TEST_CASE("what is to be shown reads back") {
  for (const char* text :
       {"picture", "q", "exitance", "error", "difference:quadgraph-fv", "levels:1", "phi:x,12.5", "tets:y,-3,1",
        "links:z,0,0", "sigma_s_prime_deviation:x,0", "sigma_a_deviation:z,-1.5", "sigma_a_resolution:y,2"}) {
    CHECK(to_string(parse_show(text)) == text);
  }
  CHECK(parse_show("phi").axis == 2);
  for (const char* text : {"", "fluence", "phi:w", "phi:x,1,2", "levels:x", "levels:-1", "q:x", "tets:z,0,0,0",
                           "difference:magic", "sigma_a_deviation:z,0,1"}) {
    CHECK_THROWS_AS(parse_show(text), InputError);
  }
}

TEST_CASE("the cuts of all tets make up the cut of the body, with linear values on it") {
  const QuadGraph graph = QuadGraph::load(cube);
  const Level& level = graph.levels()[0];
  const glm::vec3 normal = glm::normalize(glm::vec3(0, 0, 1));
  for (const float height : {0.1f, 0.69f, 1.17f, 1.77f}) {
    FalseMesh mesh;
    add_cuts(mesh, level.vertices, level.tets, Plane(normal, height), false, [&](std::uint32_t t) {
      const glm::uvec4& tet = level.tets[t];
      return glm::vec4(level.vertices[tet.x].x, level.vertices[tet.y].x, level.vertices[tet.z].x,
                       level.vertices[tet.w].x);
    });
    CHECK(area_of(mesh) == doctest::Approx(4).epsilon(1e-4));  // a cube of 2 mm
    for (const gpu::FalseVertex& vertex : mesh) {
      CHECK(vertex.value == doctest::Approx(vertex.position.x).epsilon(1e-4).scale(1));
      CHECK(vertex.position.z == doctest::Approx(height).epsilon(1e-4));
    }
  }
}

TEST_CASE("a colour bar has round numbers inside it") {
  const Legend linear{.title = "", .unit = "", .low = 0, .high = 0.0137};
  const auto ticks = ticks_of(linear);
  CHECK(ticks.size() >= 4);
  CHECK(ticks.front().text == "0");
  for (const Tick& tick : ticks) {
    CHECK(tick.place >= -1e-6f);
    CHECK(tick.place <= 1 + 1e-6f);
    CHECK(linear.value_at(static_cast<double>(tick.place)) == doctest::Approx(std::stod(tick.text)).epsilon(1e-3));
  }
  const Legend decades{.title = "", .unit = "", .low = 2e-6, .high = 2e-3, .logarithmic = true};
  REQUIRE(ticks_of(decades).size() == 3);
  CHECK(ticks_of(decades)[1].text == "0.0001");
  CHECK(decades.place(2e-3) == doctest::Approx(1));
}

TEST_CASE("every view of the inside shows the body and names its unit; a picture comes back unchanged after them") {
  Engine engine(cube, test_device());
  engine.set_material("sigma_s_prime=2,sigma_a=0.1,eta=1.4");
  const std::size_t vertices = engine.graph().levels()[0].vertex_count();
  const std::vector<float> even(vertices, 0.2f);
  engine.set_certainty({{even, even, even, even}});
  engine.set_lights({parse_light("directional:0,0,-1:1")});
  engine.solve();
  const View view{.azimuth = 25, .elevation = 20};
  RenderOptions options{.width = 200, .height = 160};
  const std::vector<float> before = engine.render(view, options).scattered;
  for (const Quantity quantity : all_values<Quantity>()) {
    if (quantity == Quantity::picture) continue;
    options.show = {.quantity = quantity, .offset = 0.2f};
    const Picture picture = engine.render(view, options);
    CHECK(picture.false_colour);
    REQUIRE(engine.legend());
    CHECK_FALSE(engine.legend()->unit.empty());
    CHECK(picture.alpha[80 * 200 + 100] == 1);
    CHECK(picture.alpha[5 * 200 + 195] == 0);
    CHECK(*std::max_element(picture.scattered.begin(), picture.scattered.end()) <= 1);
  }
  options.show = {};
  CHECK(engine.render(view, options).scattered == before);
  CHECK_FALSE(engine.legend());
  options.show = {.quantity = Quantity::levels, .level = 7};
  CHECK_THROWS_AS(engine.render(view, options), InputError);
  for (const auto& message : engine.device().validation_messages()) FAIL_CHECK(message);
}

TEST_CASE("the lit face of a cube is yellow in q, the others are at the dark end") {
  Engine engine(cube, test_device());
  engine.set_material("sigma_s_prime=2,sigma_a=0.1,eta=1.4");
  engine.set_lights({parse_light("directional:0,0,-1:1")});
  engine.solve();
  const RenderOptions options{.width = 64, .height = 64, .show = {.quantity = Quantity::q}};
  const auto middle = [&](float azimuth) {
    const Picture picture = engine.render({.azimuth = azimuth, .elevation = 0}, options);
    const float* rgb = &picture.scattered[3 * (32 * 64 + 32)];
    return glm::vec3(rgb[0], rgb[1], rgb[2]);
  };
  CHECK(glm::distance(middle(0), gpu::mapped_colour(1, 0)) < 0.03f);
  CHECK(glm::distance(middle(180), gpu::mapped_colour(0, 0)) < 0.03f);
}

TEST_CASE("deviations have the colours of their percent on the plane, and go with the material") {
  Engine engine(cube, test_device());
  const std::string material = "sigma_s_prime=2,sigma_a=0.1,eta=1.4";
  engine.set_material(material);
  engine.set_lights({parse_light("directional:0,0,-1:1")});
  engine.solve();
  RenderOptions options{.width = 64, .height = 64, .show = {.quantity = Quantity::sigma_a_deviation}};
  const auto middle = [&] {
    const Picture picture = engine.render({.azimuth = 0, .elevation = 0}, options);
    const float* rgb = &picture.scattered[3 * (32 * 64 + 32)];
    return glm::vec3(rgb[0], rgb[1], rgb[2]);
  };
  const auto no_deviations =
      "show sigma_a_deviation: no deviations in this material; those that 'quadgraph acquire' "
      "writes (.npz) have them";
  CHECK_THROWS_WITH_AS(middle(), no_deviations, InputError);
  const std::size_t vertices = engine.graph().levels()[0].vertex_count();
  const std::vector<float> none;
  const auto all = [&](float value) { return std::vector<float>(vertices, value); };
  engine.set_certainty({{all(2), all(0.1f), none, all(3)}});
  CHECK(engine.certainty().states(Knowledge::sigma_a_deviation));
  CHECK(glm::distance(middle(), gpu::mapped_colour(0.5f, 0)) < 0.01f);  // 10% between 1 and 100
  options.show.quantity = Quantity::sigma_s_prime_deviation;
  CHECK(glm::distance(middle(), gpu::mapped_colour(1, 0)) < 0.01f);  // beyond the bar
  options.show.quantity = Quantity::sigma_a_resolution;
  CHECK(glm::distance(middle(), gpu::mapped_colour(0, 0)) < 0.01f);  // the best that is known of this body
  engine.set_certainty({{none, none, none, all(1e3f)}});
  CHECK(glm::distance(middle(), gpu::mapped_colour(1, 0)) < 0.01f);
  engine.set_certainty({{all(2), all(0.1f), none, all(3)}});
  options.show.quantity = Quantity::sigma_s_prime_resolution;
  CHECK_THROWS_WITH_AS(middle(),
                       "show sigma_s_prime_resolution: no resolution lengths in this material; those that 'quadgraph "
                       "acquire --volume' writes (.npz) have them",
                       InputError);
  CHECK_THROWS_AS(engine.set_certainty({{all(1), {1.0f}, none, none}}), InputError);
  CHECK(engine.certainty().states(Knowledge::sigma_a_deviation));
  engine.set_material(material);
  CHECK_FALSE(engine.certainty().states(Knowledge::sigma_a_deviation));
  engine.solve();
  options.show.quantity = Quantity::sigma_a_deviation;
  CHECK_THROWS_WITH_AS(middle(), no_deviations, InputError);
}
