#include "engine/app/body_choice.h"

#include <algorithm>

namespace quadgraph {
const std::string& chosen_material(const State& state) {
  return said_material(state.scene, state.body);
}

void choose_material(State& state, const std::string& text) {
  if (!state.body.empty()) {
    state.scene.materials[state.body] = text;
    return;
  }
  state.scene.material = text;
  state.scene.materials.clear();
}

void choose_body(State& state, std::optional<std::uint32_t> number) {
  if (state.bodies.size() < 2) return;
  const bool one = number && *number < state.bodies.size();
  state.body = one ? state.bodies[*number] : std::string();
  state.say(one ? "Body: " + state.body : "All bodies");
}

void take_bodies(State& state, const std::vector<std::string>& bodies) {
  state.bodies = bodies;
  if (std::ranges::find(bodies, state.body) == bodies.end()) state.body.clear();
}

}  // namespace quadgraph
