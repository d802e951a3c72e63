// What keys do to a scene.
#include "engine/app/commands.h"

#include <GLFW/glfw3.h>
#include <doctest/doctest.h>

#include <set>

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
