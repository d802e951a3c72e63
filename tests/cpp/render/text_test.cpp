// What users type: lights, views, exposure, background.
#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include "engine/base/error.h"
#include "engine/render/display/camera.h"
#include "engine/render/light/lights.h"
#include "engine/render/picture/tone_map.h"

using namespace quadgraph;

TEST_CASE("a directional light keeps direction and irradiance") {
  const Light light = parse_light("directional:0,-3,4:1e-3/2e-3/0");
  CHECK(light.kind == LightKind::directional);
  CHECK(glm::distance(light.direction, glm::vec3(0, -0.6f, 0.8f)) < 1e-6f);
  CHECK(light.power == glm::vec3(1e-3f, 2e-3f, 0));
  CHECK(parse_light("directional:0,0,-1:5").power == glm::vec3(5));
}

TEST_CASE("a point light keeps position and power") {
  const Light light = parse_light("point:-1.5,2,+30:0.5");
  CHECK(light.kind == LightKind::point);
  CHECK(light.position == glm::vec3(-1.5f, 2, 30));
  CHECK(light.power == glm::vec3(0.5f));
}

TEST_CASE("ambient light has an irradiance and nothing else") {
  const Light light = parse_light("ambient:0.5/1/2");
  CHECK(light.kind == LightKind::ambient);
  CHECK(light.power == glm::vec3(0.5f, 1, 2));
  CHECK(to_string(light) == "ambient:0.5/1/2");
  CHECK_THROWS_WITH_AS(parse_light("ambient:1,2,3:4"), doctest::Contains("ambient:IRRADIANCE"), InputError);
  CHECK_THROWS_WITH_AS(parse_light("ambient:-1"), doctest::Contains("from 0 to 1e15"), InputError);
}

TEST_CASE("the text of a light reads back as the same light") {
  for (const char* text :
       {"directional:1,2,-3:0.1/0.2/0.3", "point:1e-3,7,123456:4", "spot:1,2,3:4,5,6:20:0.1",
        "spot:1,2,3:0,0,-1:90,1:0.1/0.2/0.3", "rectangle:1,2,3:4,0,0:0,5,6:7", "projector:1,2,3:0,0,1:25:a/b.png:3",
        "projector:1,2,3:0,0,1:25,1,1,0:b.exr:3/2/1", "environment:a.hdr:20:3", "environment:a.hdr:-20,z:1/2/3"}) {
    const Light light = parse_light(text), again = parse_light(to_string(light));
    CHECK(again.kind == light.kind);
    CHECK(glm::distance(again.direction, light.direction) < 1e-6f);
    CHECK(to_string(again) == to_string(light));
    CHECK(again.power == light.power);
    CHECK(again.up == light.up);
    CHECK(again.file == light.file);
    CHECK(again.turn == light.turn);
  }
}

TEST_CASE("a wrong light is refused with what was found and what is allowed") {
  CHECK_THROWS_WITH_AS(parse_light("spot:0,0,1:1"), doctest::Contains("spot:0,0,1:1"), InputError);
  CHECK_THROWS_WITH_AS(parse_light("spot:0,0,1:1"), doctest::Contains("directional:DX,DY,DZ:IRRADIANCE"), InputError);
  CHECK_THROWS_WITH_AS(parse_light("directional:0,0,0:1"), doctest::Contains("length 0"), InputError);
  CHECK_THROWS_WITH_AS(parse_light("directional:0,0,1:-1"), doctest::Contains("from 0 to 1e15"), InputError);
  CHECK_THROWS_WITH_AS(parse_light("point:0,zero,1:1"), doctest::Contains("'zero'"), InputError);
  for (const char* text : {"",
                           "directional",
                           "directional:0,0,1",
                           "directional:0,1:1",
                           "directional:0,0,1:1:1",
                           "directional:0,0,1:1/2",
                           "spot:0,0,1:0,0,1:0:1",
                           "spot:0,0,1:0,0,1:91:1",
                           "spot:0,0,1:0,0,1:10,2:1",
                           "spot:0,0,1:0,0,1:10,0,0:1",
                           "rectangle:0,0,1:1,0,0:2,0,0:1",
                           "rectangle:0,0,1:1,0,0:1",
                           "environment:a.hdr:0,x:1",
                           "environment::0:1",
                           "environment:a.hdr:1",
                           "projector:0,0,1:0,0,1:170:a.png:1",
                           "projector:0,0,1:0,0,1:20,0,0,1:a.png:1",
                           "projector:0,0,1:0,0,1:20::1",
                           "point:0,0,1:nan",
                           "point:0,0,inf:1",
                           "point:0,0,1:1x"}) {
    CAPTURE(text);
    CHECK_THROWS_AS(parse_light(text), InputError);
  }
}

TEST_CASE("a view reads its angles and, if given, its distance") {
  const View view = parse_view("30,-15.5,200", {.up = UpAxis::z, .vertical_fov = 40});
  CHECK(view.azimuth == 30);
  CHECK(view.elevation == -15.5f);
  CHECK(view.distance == 200);
  CHECK(view.up == UpAxis::z);
  CHECK(view.vertical_fov == 40);
  CHECK_FALSE(parse_view("30,10").distance.has_value());
  CHECK(to_string(view) == "30,-15.5,200");
  CHECK_THROWS_WITH_AS(parse_view("30,91"), doctest::Contains("-90 to 90"), InputError);
  CHECK_THROWS_WITH_AS(parse_view("30,10,0"), doctest::Contains("more than 0 mm"), InputError);
  CHECK_THROWS_AS(parse_view("30"), InputError);
  CHECK_THROWS_AS(parse_view("30,10,1,2"), InputError);
  CHECK_THROWS_AS(parse_view("30,10", {.vertical_fov = 180}), InputError);
}

TEST_CASE("exposure is automatic or a number of stops") {
  CHECK_FALSE(parse_exposure("auto").has_value());
  CHECK(parse_exposure("-1.5") == -1.5f);
  CHECK_THROWS_WITH_AS(parse_exposure("bright"), doctest::Contains("'bright'"), InputError);
}

TEST_CASE("a background is a name, a grey or a colour between black and white") {
  ToneOptions options;
  parse_background("0.1/0.2/0.3", options);
  CHECK(options.background_top == glm::vec3(0.1f, 0.2f, 0.3f));
  CHECK(options.background_bottom == options.background_top);
  parse_background("white", options);
  CHECK(options.background_top == glm::vec3(1));
  parse_background("transparent", options);
  CHECK(options.transparent);
  parse_background("studio", options);
  CHECK(!options.transparent);
  CHECK(options.background_bottom == ToneOptions().background_bottom);
  CHECK_THROWS_WITH_AS(parse_background("2", options), doctest::Contains("[0, 1]"), InputError);
  CHECK_THROWS_AS(parse_background("blue", options), InputError);
}
