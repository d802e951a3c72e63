// What keys do to a scene.
#include "engine/app/commands.h"

#include <GLFW/glfw3.h>
#include <doctest/doctest.h>

#include <set>

#include "engine/app/modes.h"

using namespace quadgraph;

namespace {

// The views of the inside that a key goes through until it is where it was.
std::set<Quantity> round_trip(int mods, const CommandContext& context) {
  State state;
  std::set<Quantity> seen;
  do {
    CHECK(run_command(GLFW_KEY_V, mods, state, context));
    seen.insert(state.scene.render.show.quantity);
  } while (state.scene.render.show.quantity != Quantity::picture);
  return seen;
}

}  // namespace

TEST_CASE("a key goes through all views of the inside, and past those of a certainty that is not stated") {
  CommandContext context;
  for (const int mods : {0, GLFW_MOD_SHIFT}) {
    context.known.fill(true);
    CHECK(round_trip(mods, context).size() == all_values<Quantity>().size());
    context.known = {true, false, false, true};
    const std::set<Quantity> seen = round_trip(mods, context);
    CHECK(seen.size() == all_values<Quantity>().size() - 2);
    CHECK(!seen.contains(Quantity::sigma_a_deviation));
    CHECK(!seen.contains(Quantity::sigma_s_prime_resolution));
  }
}

TEST_CASE("Esc leaves a mode before it quits") {
  const CommandContext context;
  State state;
  for (const int key : {GLFW_KEY_F1, GLFW_KEY_P, GLFW_KEY_K}) {
    CHECK(run_command(key, 0, state, context));
    CHECK((state.help || state.brush.on || state.knife.on));
    CHECK(run_command(GLFW_KEY_ESCAPE, 0, state, context));
    CHECK(!(state.help || state.brush.on || state.knife.on || state.quit));
  }
  CHECK(run_command(GLFW_KEY_ESCAPE, 0, state, context));
  CHECK(state.quit);
}

TEST_CASE("the knife takes a method that can cut, and gives it back when nothing is cut any more") {
  const CommandContext context;
  State state;
  state.methods = {Method::fem, Method::quadgraph_fv};
  state.scene.solve.method = Method::quadgraph_fv;
  state.scene.render.show.quantity = Quantity::phi;
  const Scene before = state.scene;
  const auto press = [&](int key) {
    CHECK(run_command(key, 0, state, context));
    keep_method(state);
  };
  press(GLFW_KEY_K);
  CHECK(state.scene.solve.method == Method::shortest_path);
  CHECK(state.scene.render.show == Show{});
  press(GLFW_KEY_K);
  CHECK(state.scene == before);
  press(GLFW_KEY_K);
  state.scene.cuts.resize(1);
  press(GLFW_KEY_ESCAPE);
  CHECK(!state.knife.on);
  CHECK(state.scene.solve.method == Method::shortest_path);  // there is still something cut
  press(GLFW_KEY_G);
  CHECK(state.scene.solve.method == Method::shortest_path);
  CHECK(state.refused);
  state.scene.cuts.clear();  // as undo does
  keep_method(state);
  CHECK(state.scene == before);
  state.scene.solve.method = Method::shortest_path;  // by hand: this stays
  press(GLFW_KEY_K);
  press(GLFW_KEY_K);
  CHECK(state.scene.solve.method == Method::shortest_path);
}
