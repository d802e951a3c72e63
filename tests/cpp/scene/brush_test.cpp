// What the brush does to a scene.
#include "engine/scene/brush.h"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include "engine/base/error.h"

using namespace quadgraph;

TEST_CASE("a stroke follows the hand in steps of the brush's size") {
  const Brush brush = Brush::for_body(15);
  Scene scene;
  scene.layers = {{.name = "Layer 1"}};
  brush.begin(scene, 0, {{.at = {0, 0, 0}}});
  REQUIRE(scene.layers[0].edits.size() == 1);
  check_edit(scene.layers[0].edits[0]);
  for (int i = 1; i <= 100; ++i) brush.lead(scene, 0, {{.at = {0.05f * static_cast<float>(i), 0, 0}}});
  const auto& stroke = scene.layers[0].edits[0].stroke;
  CHECK(stroke.size() > 12);
  CHECK(stroke.size() < 20);
  CHECK(stroke.back().x > 5 - 0.4f);
  brush.begin(scene, 0, {{.at = {0, 3, 0}}});
  CHECK(scene.layers[0].edits.size() == 2);
}

TEST_CASE("a touch does what the tool says, in a layer that it makes where there is none") {
  Brush brush = Brush::for_body(15);
  Scene scene;
  std::size_t layer = 0;
  CHECK(brush.touch(scene, layer, {}));
  brush.go_on(scene, layer, {{.at = {5, 0, 0}}});
  REQUIRE(scene.layers.size() == 1);
  REQUIRE(scene.layers[0].edits.size() == 1);
  CHECK(scene.layers[0].edits[0].stroke.size() == 2);
  scene.layers[0].visible = false;
  const Scene before = scene;
  CHECK_THROWS_WITH_AS(brush.touch(scene, layer, {}), doctest::Contains("'Layer 1' is hidden"), InputError);
  CHECK(scene == before);
  scene.layers[0].visible = true;
  brush.tool = BrushTool::pick;
  CHECK(!brush.touch(scene, layer, {}));  // a drag does not paint with what has just been picked up
  CHECK(brush.tool == BrushTool::paint);
  brush.tool = BrushTool::erase;
  CHECK(brush.touch(scene, layer, {}));
  CHECK(scene.layers[0].edits.empty());
  brush.go_on(scene, 7, {});  // the layer has gone meanwhile
}

TEST_CASE("paint has the colour that was asked for, as strong as that, and can be picked and erased") {
  Brush brush = Brush::for_body(15);
  Scene scene;
  scene.layers = {{.name = "Layer 1"}};
  scene.material = "wholemilk";
  const MaterialLook own = look_of(scene.material).value();
  const auto painted = [&](float strength) {
    brush.strength = strength;
    brush.begin(scene, 0, {{.at = {0, 0, 0}}});
    const Edit& edit = scene.layers[0].edits.back();
    check_edit(edit);
    CHECK(edit.operation == EditOperation::set);
    gpu::Material material{};
    material.sigma_s_prime = edit.sigma_s_prime.value();
    material.sigma_a = edit.sigma_a.value();
    material.eta = own.eta;
    return look_of(material);
  };
  const MaterialLook whole = painted(1), none = painted(0);
  CHECK(glm::distance(whole.colour, brush.look.colour) < 0.01f);
  CHECK(whole.distance == doctest::Approx(brush.look.distance).epsilon(0.01));
  CHECK(glm::distance(none.colour, own.colour) < 0.02f);
  brush.strength = 1;
  scene.layers[0].edits.pop_back();
  const glm::vec3 red = brush.look.colour;
  brush.pick(scene, {{.at = {5, 0, 0}}});  // beside the stroke
  CHECK(glm::distance(brush.look.colour, own.colour) < 0.01f);
  brush.pick(scene, {{.at = {0.1f, 0, 0}}});
  CHECK(glm::distance(brush.look.colour, red) < 0.01f);
  Brush::erase(scene.layers[0], {{.at = {5, 0, 0}}});
  CHECK(scene.layers[0].edits.size() == 1);
  Brush::erase(scene.layers[0], {{.at = {0.1f, 0, 0}}});
  CHECK(scene.layers[0].edits.empty());
  Brush::erase(scene.layers[0], {{.at = {0, 0, 0}}});
}

TEST_CASE("of several bodies a stroke begins from the colour of the one that is touched") {
  Brush brush = Brush::for_body(15);
  Scene scene;
  scene.material = "wholemilk";
  scene.materials = {{"stone", "reflectance=.1/.6/.1,mean_free_path=1"}};
  scene.layers = {{.name = "Layer 1"}};
  Touch touch{{.at = {0, 0, 0}}};
  const auto picked = [&] {
    brush.pick(scene, touch);
    return brush.look.colour;
  };
  const glm::vec3 milk = picked();
  touch.body = "stone";
  CHECK(glm::distance(picked(), glm::vec3(.1f, .6f, .1f)) < 0.03f);
  touch.body = "cup";
  CHECK(picked() == milk);
  brush.strength = 0;  // nothing of the brush
  touch.body = "stone";
  brush.begin(scene, 0, touch);
  gpu::Material material{};
  material.sigma_s_prime = scene.layers[0].edits[0].sigma_s_prime.value();
  material.sigma_a = scene.layers[0].edits[0].sigma_a.value();
  material.eta = look_of(scene.materials["stone"])->eta;
  CHECK(glm::distance(look_of(material).colour, glm::vec3(.1f, .6f, .1f)) < 0.03f);
}

TEST_CASE("a material of a colour and a distance shows them") {
  for (const Swatch& swatch : swatches()) {
    if (swatch.name == "spectralon") continue;  // absorbs nothing: no colour has an inverse there
    const MaterialLook look = look_of(material_of(swatch.look)).value();
    CHECK_MESSAGE(glm::distance(look.colour, swatch.look.colour) < 0.03f, swatch.name);
    CHECK(look.eta == doctest::Approx(swatch.look.eta));
  }
  CHECK(!look_of("wax.npz"));
}

TEST_CASE("a stamp lies on the surface where the brush touches it, the way up that is seen") {
  ImagePyramid image{.columns = 40, .rows = 20, .levels = 1, .texels = std::vector<glm::vec3>(800, glm::vec3(1))};
  Brush brush = Brush::for_body(15);
  brush.edit.image = std::make_shared<const ImagePyramid>(image);
  brush.edit.softness = 100;
  Scene scene;
  scene.layers = {{.name = "Layer 1"}};
  const glm::vec3 there(0, 0, 10);
  brush.begin(scene, 0, {{there, {0, 0, -1}, {0, 1, 0}}});
  brush.lead(scene, 0, {{there + glm::vec3(0.01f, 0, 0), {0, 0, -1}, {0, 1, 0}}});
  REQUIRE(scene.layers[0].edits.size() == 1);
  check_edit(scene.layers[0].edits[0]);
  const Placement placement = scene.layers[0].edits[0].placement.value();
  CHECK(placement.centre.x == 0.01f);
  CHECK(placement.size.x == doctest::Approx(2 * brush.edit.radius));
  CHECK(placement.size.y == doctest::Approx(brush.edit.radius));
  CHECK(scene.layers[0].edits[0].softness <= 0.25f * placement.size.y);
  CHECK(scene.layers[0].edits[0].stroke.empty());
}

TEST_CASE("what the brush touches goes with a body that has been turned and stretched") {
  // At rest a triangle in the plane x = 2, seen from +x; now it lies in z = 7, twice as high.
  const std::vector<glm::vec3> rest = {{2, 0, 0}, {2, 0, -1}, {2, 1, 0}}, now = {{0, 0, 7}, {1, 0, 7}, {0, 2, 7}};
  const std::vector<glm::uvec3> triangles = {{0, 1, 2}};
  const DisplayMesh mesh{rest, {}, triangles, {}, {}};
  const Camera camera = place_camera({.elevation = 0}, {{0.3f, 0.5f, 7}, 1}, 1);
  const auto picked = pick(mesh, now, camera, {0, 0});
  REQUIRE(picked.has_value());
  const TouchPlace touch = touched(*picked, camera);
  CHECK(glm::distance(touch.at, glm::vec3(2, 0.25f, -0.3f)) < 1e-5f);
  CHECK(glm::distance(touch.inward, glm::vec3(-1, 0, 0)) < 1e-5f);
  CHECK(glm::distance(touch.upright, glm::vec3(0, 1, 0)) < 1e-5f);
  const Camera above = place_camera({.elevation = 90}, {{0.3f, 0.5f, 7}, 1}, 1);  // upright is then across what is seen
  const Picked flat{.position = {0, 0, 0}, .at_rest = {0, 0, 0}, .normal = above.up};
  CHECK(glm::distance(touched(flat, above).upright, -above.backward) < 1e-5f);
}
