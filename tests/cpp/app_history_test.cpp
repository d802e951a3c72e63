// Going back and forth between scenes, and strokes of the brush.
#include <doctest/doctest.h>

#include "engine/app/brush.h"
#include "engine/app/history.h"

using namespace quadgraph;

TEST_CASE("scenes come back in turn, and are seen from where the eye is") {
  Scene scene;
  History history(scene);
  CHECK(!history.can_undo());
  CHECK(history.undo(scene) == scene);
  for (const char* material : {"jade", "skin1", "wax"}) {
    scene.material = material;
    history.note(scene);
    history.note(scene);  // the same again is no step
  }
  scene.view.azimuth = 33;
  history.note(scene);  // nor is another view
  scene = history.undo(scene);
  CHECK(scene.material == "skin1");
  scene.view.azimuth = 66;
  scene = history.undo(scene);
  CHECK(scene.material == "jade");
  CHECK(scene.view.azimuth == 66);
  scene = history.redo(scene);
  CHECK(scene.material == "skin1");
  CHECK(history.can_redo());
  scene.material = "ketchup";
  history.note(scene);
  CHECK(!history.can_redo());  // what was taken back is gone once something else is done
  scene = history.undo(history.undo(history.undo(scene)));
  CHECK(scene.material == Scene().material);
  CHECK(!history.can_undo());
}

TEST_CASE("what could not be shown is no step to go back to") {
  Scene scene;
  History history(scene);
  scene.material = "jade";
  history.note(scene);
  Scene refused = scene;
  refused.material = "none.npz";
  history.note(refused);
  history.refuse(refused);
  history.note(scene);
  CHECK(history.undo(scene).material == Scene().material);
  history.refuse(refused);  // which is not what was noted last
  CHECK(history.can_redo());
}

TEST_CASE("a stroke follows the hand in steps of the brush's size") {
  const Brush brush = Brush::for_body(15);
  Scene scene;
  brush.begin(scene, {0, 0, 0});
  REQUIRE(scene.edits.size() == 1);
  check_edit(scene.edits[0]);
  for (int i = 1; i <= 100; ++i) brush.lead(scene, {0.05f * static_cast<float>(i), 0, 0});
  const auto& stroke = scene.edits[0].stroke;
  CHECK(stroke.size() > 12);
  CHECK(stroke.size() < 20);
  CHECK(stroke.back().x > 5 - 0.4f);
  brush.begin(scene, {0, 3, 0});
  CHECK(scene.edits.size() == 2);
}
