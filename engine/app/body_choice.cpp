#include "engine/app/body_choice.h"

#include <algorithm>

#include "engine/app/material_look.h"
#include "engine/base/text.h"
#include "engine/optics/material.h"

namespace quadgraph {
namespace {

const std::string& material_of_body(const Scene& scene, const std::string& body) {
  const auto own = scene.materials.find(body);
  return own == scene.materials.end() ? scene.material : own->second;
}

}  // namespace

const std::string& chosen_material(const State& state) {
  return material_of_body(state.scene, state.body);
}

void choose_material(State& state, const std::string& text) {
  if (!state.body.empty()) {
    state.scene.materials[state.body] = text;
    return;
  }
  state.scene.material = text;
  state.scene.materials.clear();
}

std::string at_index_of_others(const State& state, const std::string& name) {
  const auto other = std::ranges::find_if(state.bodies, [&](const std::string& each) { return each != state.body; });
  if (state.body.empty() || other == state.bodies.end()) return name;
  const auto& look = look_of(material_of_body(state.scene, *other));
  if (!look || look->eta == parse_material(name).eta) return name;
  return name + ",eta=" + number_text(look->eta);
}

void take_bodies(State& state, const std::vector<std::string>& bodies) {
  state.bodies = bodies;
  if (std::ranges::find(bodies, state.body) == bodies.end()) state.body.clear();
}

}  // namespace quadgraph
