// A stage whose next body is made while the one before is still shown.
#include "engine/scene/stage.h"

#include <doctest/doctest.h>

#include "tests/cpp/fixtures/test_data.h"
#include "tests/cpp/fixtures/test_device.h"

using namespace quadgraph;

TEST_CASE("a body is prepared beside the one that is shown, and takes its place with the next scene of its file") {
  Stage stage(test_device());
  Scene scene{.body = test_data("tiny.qgraph")};
  stage.show(scene);
  const Engine* const first = &stage.engine();
  stage.take_up(Stage::load(test_data("two_cubes.qgraph")));
  stage.prepare();
  CHECK(&stage.engine() == first);
  CHECK(stage.scene().body == scene.body);
  Stage plain(test_device());
  scene.body = test_data("two_cubes.qgraph");
  for (Stage* each : {&stage, &plain}) {
    each->show(scene);
    each->solve();
  }
  CHECK(stage.engine().surface_field().exitance == plain.engine().surface_field().exitance);
}

TEST_CASE("a body that is shown already is not made again") {
  Stage stage(test_device());
  const Scene scene{.body = test_data("tiny.qgraph")};
  stage.show(scene);
  const std::uint64_t made = stage.engine().device().allocation_count();
  stage.take_up(Stage::load(scene.body));
  stage.prepare();
  CHECK(stage.engine().device().allocation_count() == made);
}

TEST_CASE("a body that was prepared and is not shown next is forgotten") {
  Stage stage(test_device());
  const Scene scene{.body = test_data("tiny.qgraph")};
  stage.show(scene);
  const Engine* const first = &stage.engine();
  stage.take_up(Stage::load(test_data("two_cubes.qgraph")));
  stage.prepare();
  stage.show(scene);
  CHECK(&stage.engine() == first);
  Scene other = scene;
  other.body = test_data("nested_cubes.qgraph");
  stage.take_up(Stage::load(test_data("two_cubes.qgraph")));
  stage.prepare();
  stage.show(other);
  CHECK(stage.engine().graph().bodies().size() == 2);
  CHECK(stage.loaded().path == other.body);
}
