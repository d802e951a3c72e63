// Bodies that move on their own: their motions, and what that leaves of a shape.
#include "engine/deform/body_poses.h"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include "engine/base/error.h"
#include "engine/deform/deform.h"

using namespace quadgraph;

namespace {

QuadGraph cubes() {
  return QuadGraph::load(QUADGRAPH_TEST_DATA "/two_cubes.qgraph");
}

glm::dvec3 middle_of(const QuadGraph& graph, const VertexBodies& bodies, std::uint32_t body) {
  RestBox box{glm::dvec3(1e9), glm::dvec3(-1e9)};
  for (std::size_t v = 0; v < graph.display().vertices.size(); ++v) {
    if (bodies.display[v] != body) continue;
    box.low = glm::min(box.low, glm::dvec3(graph.display().vertices[v]));
    box.high = glm::max(box.high, glm::dvec3(graph.display().vertices[v]));
  }
  return 0.5 * (box.low + box.high);
}

}  // namespace

TEST_CASE("a body turns about its own middle, about x, then y, then z, and then moves; others stay") {
  const QuadGraph graph = cubes();
  const auto bodies = std::make_shared<const VertexBodies>(vertex_bodies(graph));
  const auto moves = rigid_moves(graph, *bodies, {{"right", {.position = {1, 2, 3}, .rotation = {90, 0, 90}}}});
  REQUIRE(moves.size() == 2);
  CHECK(moves[0] == RigidMove());
  const glm::dvec3 middle = middle_of(graph, *bodies, 1);
  const auto moved = [&](const glm::dvec3& p) { return moves[1].turn * p + moves[1].shift; };
  CHECK(glm::distance(moved(middle), middle + glm::dvec3(1, 2, 3)) < 1e-12);
  // y goes to z about x, and stays about z; x goes to y about z.
  CHECK(glm::distance(moves[1].turn * glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)) < 1e-12);
  CHECK(glm::distance(moves[1].turn * glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0)) < 1e-12);
  const Deformer step = placed(moves, bodies);
  const RestBox rest = rest_box(graph.display().vertices);
  for (std::uint32_t i = 0; i < graph.levels().size(); ++i) {
    const Level& level = graph.levels()[i];
    const auto found = deformed({&step, 1}, rest, i, level.vertices);
    for (std::uint32_t t = 0; t < level.tet_count(); ++t) {
      for (int k = 0; k < 4; ++k) {
        const std::uint32_t v = level.tets[t][k];
        const glm::dvec3 at_rest(level.vertices[v]);
        CHECK(glm::distance(found[v], level.body_of_tet(t) == 1 ? moved(at_rest) : at_rest) < 1e-12);
      }
    }
  }
}

TEST_CASE("poses of bodies that a file does not have, and numbers beyond what is of use, are refused by name") {
  const QuadGraph graph = cubes(), alone = QuadGraph::load(QUADGRAPH_TEST_DATA "/tiny.qgraph");
  const VertexBodies bodies = vertex_bodies(graph);
  const auto refused = [](const QuadGraph& of, const VertexBodies& known, const BodyPoses& poses, const char* said) {
    CHECK_THROWS_WITH_AS(rigid_moves(of, known, poses), doctest::Contains(said), InputError);
  };
  refused(graph, bodies, {{"lid", {}}}, "a body 'lid' found, the bodies of the file are left, right");
  refused(graph, bodies, {{"left", {.position = {0, 1e6, 0}}}}, "placements: left: position: found 1e+06");
  refused(graph, bodies, {{"left", {.rotation = {0, 0, NAN}}}}, "placements: left: rotation: found nan");
  refused(alone, vertex_bodies(alone), {{"left", {}}}, "the file has one body without a name");
}

TEST_CASE("what lists of steps leave of a shape") {
  const QuadGraph graph = cubes();
  const auto bodies = std::make_shared<const VertexBodies>(vertex_bodies(graph));
  const auto put = [&](double x) {
    return placed(rigid_moves(graph, *bodies, {{"right", {.position = {x, 0, 0}}}}), bodies);
  };
  const Deformer whole{.kind = DeformerKind::transform, .degrees = 10}, twist{.degrees = 20};
  using List = std::vector<Deformer>;
  const auto change = [](const List& one, const List& other) { return change_between(one, other); };
  CHECK(change({put(1)}, {put(1), whole}) == ShapeChange::whole);
  CHECK(change({}, {whole}) == ShapeChange::whole);
  CHECK(change({}, {put(1)}) == ShapeChange::bodies);
  CHECK(change({put(1), whole}, {put(2)}) == ShapeChange::bodies);
  CHECK(change({put(1), twist}, {put(1), twist, whole}) == ShapeChange::whole);
  CHECK(change({put(1), twist}, {put(2), twist}) == ShapeChange::shape);  // a twist of what lies elsewhere
  CHECK(change({put(1)}, {twist}) == ShapeChange::shape);
  CHECK(only_moves(List{put(1), whole}));
  CHECK(!only_moves(List{put(1), twist}));
}

TEST_CASE("the outermost body takes along what lies within it, which does not move by itself") {
  const QuadGraph graph = QuadGraph::load(QUADGRAPH_TEST_DATA "/nested_cubes.qgraph");
  REQUIRE(graph.outermost() == std::vector<std::uint32_t>{1, 1});
  const VertexBodies bodies = vertex_bodies(graph);
  const BodyPose pose{.position = {4, 0, 0}, .rotation = {0, 90, 0}};
  const std::vector<RigidMove> moves = rigid_moves(graph, bodies, {{"outer", pose}});
  CHECK(moves[0] == moves[1]);
  CHECK(glm::distance(moves[0].turn * glm::dvec3(1.5) + moves[0].shift, glm::dvec3(5.5, 1.5, 1.5)) < 1e-12);
  CHECK_THROWS_WITH_AS(
      rigid_moves(graph, bodies, {{"inner", pose}}),
      "placements: inner found, which lies within outer and shares its surface with it: place outer, which takes inner "
      "along, or bake it where it is to lie",
      InputError);
  CHECK(rigid_moves(graph, bodies, {{"inner", BodyPose()}}) == std::vector<RigidMove>(2));
}
