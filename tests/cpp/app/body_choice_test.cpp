// The body whose material the window changes.
#include "engine/app/body_choice.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <map>

#include "engine/render/display/outline.h"

using namespace quadgraph;

TEST_CASE("a material goes to the body that was chosen, or to all") {
  State state;
  take_bodies(state, {"cup", "stone"}, {0, 1});
  choose_material(state, "wax");
  CHECK(chosen_material(state) == "wax");
  state.body = "stone";
  CHECK(chosen_material(state) == "wax");
  choose_material(state, "jade");
  CHECK(chosen_material(state) == "jade");
  CHECK(state.scene.material == "wax");
  state.body = "cup";
  CHECK(chosen_material(state) == "wax");
  state.body.clear();
  choose_material(state, "marble");
  CHECK(state.scene.materials.empty());
  state.body = "stone";
  CHECK(chosen_material(state) == "marble");
}

TEST_CASE("a click chooses a body and says so, one beside them all, and of one body nothing") {
  State state;
  choose_body(state, 0);
  CHECK(state.message.empty());
  take_bodies(state, {"cup", "stone"}, {0, 1});
  choose_body(state, 1);
  CHECK(state.body == "stone");
  CHECK(state.message == "Body: stone");
  choose_body(state, std::nullopt);
  CHECK(state.body.empty());
  choose_body(state, 7);  // no body of the file
  CHECK(state.body.empty());
}

TEST_CASE("the edge of a body goes around what it covers") {
  const QuadGraph graph = QuadGraph::load(QUADGRAPH_TEST_DATA "/two_cubes.qgraph");
  const auto vertices = graph.display().vertices;
  Sphere around;
  const RestBox box = rest_box(vertices);
  around.centre = glm::vec3(0.5 * (box.low + box.high));
  around.radius = static_cast<float>(glm::length(box.high - box.low)) / 2;
  const Camera camera = place_camera({.azimuth = 0, .elevation = 0}, around, 2);
  const auto left = outline_of(graph, vertices, 0, camera, 2), right = outline_of(graph, vertices, 1, camera, 2);
  REQUIRE(left.size() > 100);
  REQUIRE(right.size() > 100);
  float most = -1, least = 1;
  for (const Segment& segment : left) most = std::max(most, segment[0].x);
  for (const Segment& segment : right) least = std::min(least, segment[0].x);
  CHECK(most < least);  // they stand beside each other
  CHECK(outline_of(graph, vertices, 2, camera, 2).empty());
  // A closed line: as many segments end in each place as begin there, two.
  std::map<std::pair<float, float>, int> ends;
  for (const Segment& segment : left) {
    for (const glm::vec2& end : segment) ++ends[{end.x, end.y}];
  }
  for (const auto& [place, count] : ends) CHECK(count == 2);
}

TEST_CASE("another file has other bodies") {
  State state;
  take_bodies(state, {"cup", "stone"}, {0, 1});
  state.body = "stone";
  take_bodies(state, {"stone", "lid"}, {0, 1});
  CHECK(state.body == "stone");
  take_bodies(state, {}, {});
  CHECK(state.body.empty());
}

TEST_CASE("a body within others moves with the outermost") {
  State state;
  take_bodies(state, {"core", "stone", "jelly"}, {2, 2, 2});
  CHECK(moves_with(state).empty());
  state.body = "core";
  CHECK(moves_with(state) == "jelly");
  state.body = "jelly";
  CHECK(moves_with(state).empty());
}
