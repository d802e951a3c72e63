#include "engine/app/material_section.h"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>

#include "engine/app/body_choice.h"
#include "engine/app/panel_widgets.h"
#include "engine/optics/coat.h"
#include "engine/optics/material.h"
#include "engine/render/picture/tone_map.h"
#include "engine/scene/material_look.h"
#include "engine/scene/volume.h"

namespace quadgraph {
namespace {

constexpr int swatches_in_row = 8;
constexpr float least_mm = 0.02f, most_mm = 50;  // of how far light goes

// As rough as its name says.
void take(State& state, const std::string& name) {
  choose_material(state, name);
  state.scene.render.roughness.reset();
}

ImVec4 shown(const glm::vec3& linear) {
  return {srgb_encode(linear.x), srgb_encode(linear.y), srgb_encode(linear.z), 1};
}

// A button of two colours, the second in its lower right half; whether it was pressed.
bool swatch_button(const Swatch& swatch, bool chosen, const ImVec2& size) {
  const bool pressed = ImGui::InvisibleButton(swatch.name.c_str(), size);
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  ImDrawList* draw = ImGui::GetWindowDrawList();
  draw->AddRectFilled(low, high, ImGui::GetColorU32(shown(swatch.look.colour)), 3);
  draw->AddTriangleFilled({high.x, low.y}, high, {low.x, high.y}, ImGui::GetColorU32(shown(swatch.look.second)));
  const bool marked = chosen || ImGui::IsItemHovered() || ImGui::IsItemFocused();
  if (marked) draw->AddRect(low, high, ImGui::GetColorU32(ImGuiCol_CheckMark), 3, 0, 2);
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", swatch.name.c_str());
  return pressed;
}

void draw_swatches(State& state, float unit) {
  const float gap = 4 * unit;
  const float wide = (ImGui::GetContentRegionAvail().x - gap * (swatches_in_row - 1)) / swatches_in_row;
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {gap, gap});
  int at = 0;
  for (const Swatch& swatch : swatches()) {
    if (at++ % swatches_in_row != 0) ImGui::SameLine();
    const bool chosen = without_coat(chosen_material(state)) == swatch.name;
    if (swatch_button(swatch, chosen, {wide, 22 * unit})) take(state, swatch.name);
  }
  ImGui::PopStyleVar();
}

// Of several bodies the one whose material is changed.
void draw_bodies(State& state) {
  if (state.bodies.size() < 2) return;
  if (!ImGui::BeginCombo("Body", state.body.empty() ? "All" : state.body.c_str())) return;
  if (ImGui::Selectable("All", state.body.empty())) state.body.clear();
  for (const std::string& body : state.bodies) {
    if (ImGui::Selectable((body + "##body").c_str(), body == state.body)) state.body = body;
  }
  ImGui::EndCombo();
}

void draw_preset(State& state) {
  const auto& names = material_names();
  const std::string own = without_coat(chosen_material(state));
  const auto found = std::find(names.begin(), names.end(), own);
  const char* shown = found == names.end() ? "Custom" : found->c_str();
  if (!ImGui::BeginCombo("Preset", shown, ImGuiComboFlags_HeightLarge)) return;
  for (const std::string& name : names) {
    const bool chosen = name == own;
    if (ImGui::Selectable(name.c_str(), chosen)) take(state, name);
    if (chosen) ImGui::SetItemDefaultFocus();
  }
  ImGui::EndCombo();
}

// What is changed here makes a material of one colour of the one that was there, as rough as that.
void draw_look(State& state) {
  if (const auto look = look_of(chosen_material(state))) {
    MaterialLook changed = *look;
    const bool other_colour = colour_button("Colour##material", changed.colour);
    const bool other_distance = slide("Light goes", changed.distance, least_mm, most_mm, "%.2f mm", true);
    if (other_colour || other_distance) {
      auto& asked = state.scene.render.roughness;
      if (!asked) asked = stated_roughness(chosen_material(state));
      choose_material(state, with_coat(material_of(changed), stated_coat(chosen_material(state))));
    }
  }
  auto& asked = state.scene.render.roughness;
  float roughness = asked.value_or(stated_roughness(chosen_material(state)).value_or(default_roughness));
  if (slide("Roughness", roughness, roughness_range, "%.2f")) asked = roughness;
}

// Of no name as "Other".
std::string name_of(const Coat& coat) {
  if (coat.share == 0) return "None";
  for (const NamedCoat& each : named_coats()) {
    if (each.coat == coat) return capitalised(each.name);
  }
  return "Other";
}

// A clear layer over the material, whatever that is.
void draw_coat(State& state) {
  const Coat before = stated_coat(chosen_material(state));
  Coat coat = before;
  if (ImGui::BeginCombo("Coat", name_of(coat).c_str())) {
    if (ImGui::Selectable("None", coat.share == 0)) coat.share = 0;
    for (const NamedCoat& each : named_coats()) {
      if (ImGui::Selectable(capitalised(each.name).c_str(), each.coat == coat)) coat = each.coat;
    }
    ImGui::EndCombo();
  }
  if (before.share > 0) {
    slide("Coverage", coat.share, coat_range, "%.2f");
    slide("Coat roughness", coat.roughness, roughness_range, "%.2f");
  }
  if (coat != before) choose_material(state, with_coat(chosen_material(state), coat));
}

void draw_text(State& state) {
  if (!ImGui::IsAnyItemActive()) state.material_text = chosen_material(state);
  ImGui::PushItemWidth(-1);
  if (ImGui::InputTextWithHint("##text", "marble,sigma_a=.01/.02/.05", &state.material_text,
                               ImGuiInputTextFlags_EnterReturnsTrue)) {
    try {
      check_material_text(state.material_text);
      choose_material(state, state.material_text);
      state.say("");
    } catch (const std::exception& error) {
      state.say(error.what(), true);
    }
  }
  ImGui::PopItemWidth();
}

}  // namespace

void draw_material(State& state, float unit) {
  if (!section("Material")) return;
  draw_bodies(state);
  draw_preset(state);
  draw_swatches(state, unit);
  draw_look(state);
  draw_coat(state);
  draw_text(state);
}

}  // namespace quadgraph
