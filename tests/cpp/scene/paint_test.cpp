// What a user does to layers of strokes, and painting on both sides of a body.
#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include "engine/scene/brush.h"
#include "engine/scene/layers.h"

using namespace quadgraph;

namespace {

std::string names_of(const Scene& scene) {
  std::string names;
  for (const EditLayer& layer : scene.layers) names += layer.name + ";";
  return names;
}

// Of two layers, each with a stroke at the origin: red, and over it green.
struct TwoStrokes {
  Scene scene;
  Brush brush = Brush::for_body(15);
  std::size_t active = 0;
  glm::vec3 red, green{0.05f, 0.4f, 0.05f};

  TwoStrokes() : red(brush.look.colour) {
    scene.material = "wholemilk";
    for (const glm::vec3& colour : {red, green}) {
      add_layer(scene, active);
      brush.look.colour = colour;
      brush.begin(scene, active, {});
    }
  }

  glm::vec3 picked() {
    brush.pick(scene, {});
    return brush.look.colour;
  }
};

// A square of two triangles, and one without area, in the plane z = 1, seen from +z.
const std::vector<glm::vec3> corners = {{-2, 0, 1}, {2, 0, 1}, {2, 4, 1}, {-2, 4, 1}};
const std::vector<glm::uvec3> halves = {{1, 2, 2}, {0, 1, 2}, {0, 2, 3}};  // the first is an edge
const DisplayMesh square{corners, {}, halves, {}, {}};

}  // namespace

TEST_CASE("layers are added above the active one, moved and removed with their strokes") {
  Scene scene;
  std::size_t active = 0;
  move_layer(scene, active, true);
  remove_layer(scene, active);  // there is none
  for (int i = 0; i < 3; ++i) add_layer(scene, active);
  CHECK(names_of(scene) == "Layer 1;Layer 2;Layer 3;");
  CHECK(active == 2);
  move_layer(scene, active, true);  // is the topmost already
  CHECK(active == 2);
  move_layer(scene, active, false);
  CHECK(names_of(scene) == "Layer 1;Layer 3;Layer 2;");
  CHECK(active == 1);
  scene.layers[1].name = "Veins";
  add_layer(scene, active);
  CHECK(names_of(scene) == "Layer 1;Veins;Layer 4;Layer 2;");
  remove_layer(scene, active);
  CHECK(active == 1);
  active = 0;
  remove_layer(scene, active);
  move_layer(scene, active, false);  // is the lowest
  CHECK(names_of(scene) == "Veins;Layer 2;");
  CHECK(active == 0);
  CHECK(topmost(scene) == 1);
  active = 7;
  keep_active(scene, active);
  CHECK(active == 1);
  while (scene.layers.size() < most_layers) add_layer(scene, active);
  add_layer(scene, active);
  CHECK(scene.layers.size() == most_layers);
}

TEST_CASE("the eraser takes from one layer, and the picker from what is seen, the topmost first") {
  TwoStrokes painted;
  CHECK(glm::distance(painted.picked(), painted.green) < 0.02f);
  painted.scene.layers[1].visible = false;
  CHECK(glm::distance(painted.picked(), painted.red) < 0.02f);
  painted.scene.layers[1].visible = true;
  Brush::erase(painted.scene.layers[0], {});
  CHECK(painted.scene.layers[0].edits.empty());
  REQUIRE(painted.scene.layers[1].edits.size() == 1);
  Brush::erase(painted.scene.layers[0], {});
  CHECK(painted.scene.layers[1].edits.size() == 1);
}

TEST_CASE("a stroke on both sides is one stroke, led and erased as one") {
  const Brush brush = Brush::for_body(15);
  Scene scene;
  scene.layers = {{.name = "a"}};
  const auto touch = [](float x) { return Touch{{.at = {x, 0, 5}}, TouchPlace{.at = {-x, 0, 5}}}; };
  brush.begin(scene, 0, touch(4));
  for (int i = 1; i <= 10; ++i) brush.lead(scene, 0, touch(4 + 0.1f * static_cast<float>(i)));
  auto& edits = scene.layers[0].edits;
  REQUIRE(edits.size() == 1);
  check_edit(edits[0]);
  REQUIRE(edits[0].mirrored);
  CHECK(edits[0].stroke.size() > 2);
  for (std::size_t i = 0; i < edits[0].stroke.size(); ++i) {
    CHECK(edits[0].mirrored->stroke[i] == edits[0].stroke[i] * glm::vec3(-1, 1, 1));
  }
  Brush::erase(scene.layers[0], {{.at = {0, 0, 5}}});
  CHECK(edits.size() == 1);
  Brush::erase(scene.layers[0], {{.at = {-4, 0, 5}}});  // where its mirror image is
  CHECK(edits.empty());
  brush.lead(scene, 0, touch(4));  // there is none to lead
  CHECK(edits.empty());
}

TEST_CASE("a stamp on both sides lies at both, each upright where it lies") {
  const ImagePyramid image{.columns = 4, .rows = 4, .levels = 1, .texels = std::vector<glm::vec3>(16, glm::vec3(1))};
  Brush brush = Brush::for_body(15);
  brush.edit.mask = std::make_shared<const ImagePyramid>(image);
  Scene scene;
  scene.layers = {{.name = "a"}};
  const TouchPlace right{{3, 0, 0}, {-1, 0, 0}, {0, 1, 0}}, left{{-3, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  brush.begin(scene, 0, {right, left});
  const Edit& stamp = scene.layers[0].edits.at(0);
  check_edit(stamp);
  REQUIRE(stamp.mirrored);
  CHECK(stamp.mirrored->placement->centre == left.at);
  CHECK(stamp.mirrored->placement->direction == left.inward);
  CHECK(stamp.mirrored->placement->size == stamp.placement->size);
}

TEST_CASE("sides have the names that the body's front gives them") {
  using Names = std::array<std::string, 4>;
  CHECK(mirror_names(0, UpAxis::y) == Names{"off", "left-right (X)", "top-bottom (Y)", "front-back (Z)"});
  CHECK(mirror_names(170, UpAxis::y) == Names{"off", "left-right (X)", "top-bottom (Y)", "front-back (Z)"});
  CHECK(mirror_names(-90, UpAxis::y) == Names{"off", "front-back (X)", "top-bottom (Y)", "left-right (Z)"});
  CHECK(mirror_names(0, UpAxis::z) == Names{"off", "left-right (X)", "front-back (Y)", "top-bottom (Z)"});
  CHECK(mirror_names(90, UpAxis::z) == Names{"off", "front-back (X)", "left-right (Y)", "top-bottom (Z)"});
}

TEST_CASE("the mirrored place is on the body, however far off it the mirror puts it") {
  const glm::vec3 middle(1, 2, 3);
  CHECK(mirrored({4, 0, 0}, Mirror::x, middle) == glm::vec3(-2, 0, 0));
  CHECK(mirrored({4, 0, 0}, Mirror::z, middle) == glm::vec3(4, 0, 6));
  // Now the square lies in y = 0, twice as wide.
  const std::vector<glm::vec3> now = {{-4, 0, 0}, {4, 0, 0}, {4, 0, -4}, {-4, 0, -4}};
  const Picked inside = nearest_to(square, now, {-1, 1, 3}).value();
  CHECK(glm::distance(inside.at_rest, glm::vec3(-1, 1, 1)) < 1e-5f);
  CHECK(glm::distance(inside.position, glm::vec3(-2, 0, -1)) < 1e-5f);
  CHECK(glm::distance(inside.normal, glm::vec3(0, 1, 0)) < 1e-5f);
  CHECK(glm::distance(nearest_to(square, now, {5, 3, 2})->at_rest, glm::vec3(2, 3, 1)) < 1e-5f);     // over an edge
  CHECK(glm::distance(nearest_to(square, now, {-5, -9, 0})->at_rest, glm::vec3(-2, 0, 1)) < 1e-5f);  // over a corner
  CHECK(nearest_to(square, now, {5, 3, 2})->normal == glm::vec3(0, 1, 0));
  CHECK(!nearest_to({}, {}, {0, 0, 0}));

  const TouchPlace touch{{1, 1, 1}, {0, 0, -1}, {0.6f, 0.8f, 0}};
  const TouchPlace other = mirrored(touch, Mirror::x, inside);
  CHECK(glm::distance(other.at, inside.at_rest) < 1e-6f);
  CHECK(glm::distance(other.inward, glm::vec3(0, 0, -1)) < 1e-5f);
  CHECK(glm::distance(other.upright, glm::vec3(-0.6f, 0.8f, 0)) < 1e-5f);
}
