// The body whose material the window changes.
#include "engine/app/body_choice.h"

#include <doctest/doctest.h>

using namespace quadgraph;

TEST_CASE("a material goes to the body that was chosen, or to all") {
  State state;
  take_bodies(state, {"cup", "stone"});
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

TEST_CASE("another file has other bodies") {
  State state;
  take_bodies(state, {"cup", "stone"});
  state.body = "stone";
  take_bodies(state, {"stone", "lid"});
  CHECK(state.body == "stone");
  take_bodies(state, {});
  CHECK(state.body.empty());
}
