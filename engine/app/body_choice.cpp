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

void take_bodies(State& state, const std::vector<std::string>& bodies, const std::vector<std::uint32_t>& outermost) {
  state.bodies = bodies;
  state.outermost = outermost;
  if (std::ranges::find(bodies, state.body) == bodies.end()) state.body.clear();
}

std::string moves_with(const State& state) {
  const auto found = std::ranges::find(state.bodies, state.body);
  if (found == state.bodies.end()) return {};
  const std::string& around = state.bodies[state.outermost[static_cast<std::size_t>(found - state.bodies.begin())]];
  return around == state.body ? std::string() : around;
}

}  // namespace quadgraph
