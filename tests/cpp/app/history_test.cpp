// Going back and forth between scenes.
#include "engine/app/history.h"

#include <doctest/doctest.h>

#include "engine/scene/brush.h"
#include "engine/scene/layers.h"

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

TEST_CASE("what was before the last step is told and changes nothing") {
  Scene scene;
  History history(scene);
  const Scene first = scene;
  CHECK(history.before(scene) == scene);
  scene.material = "jade";
  history.note(scene);
  scene.view.azimuth = 50;
  CHECK(same_work(history.before(scene), first));
  CHECK(history.before(scene).view.azimuth == 50);
  CHECK(history.can_undo());
  scene.material = "wax";  // not noted yet: a slider is held
  CHECK(history.before(scene).material == "jade");
}

TEST_CASE("undo is of the body, and leaves alone by what it is solved and how it is looked at") {
  Scene scene;
  History history(scene);
  scene.material = "jade";
  history.note(scene);
  scene.body = "baked.qgraph";
  scene.view.azimuth = 20;
  scene.render.show.quantity = Quantity::phi;
  scene.solve.method = Method::quadgraph_fv;
  scene.solve.solver = SolverKind::dpcg;
  scene.solve.model = Model::sp3;
  const Scene changed = scene;
  history.note(scene);
  scene = history.undo(scene);
  CHECK(scene.material == Scene().material);
  CHECK(!history.can_undo());
  scene.material = "jade";
  CHECK(scene == changed);
  CHECK(same_work(scene, changed));
  scene.tone.white_balance = 4000;
  CHECK(!same_work(scene, changed));
}
TEST_CASE("undo brings a removed layer back, with its strokes, name and opacity") {
  const Brush brush = Brush::for_body(15);
  Scene scene;
  std::size_t active = 0;
  for (int i = 0; i < 2; ++i) {
    add_layer(scene, active);
    brush.begin(scene, active, {});
  }
  scene.layers[1].name = "Veins";
  scene.layers[1].opacity = 0.5f;
  History history(scene);
  const Scene before = scene;
  remove_layer(scene, active);
  history.note(scene);
  CHECK(scene.layers.size() == 1);
  CHECK(history.undo(scene) == before);
  CHECK(history.redo(before) == scene);
  scene.layers[0].visible = false;
  history.note(scene);
  CHECK(history.undo(scene).layers[0].visible);
}
