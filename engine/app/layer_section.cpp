#include "engine/app/layer_section.h"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>

#include "engine/app/panel_widgets.h"
#include "engine/base/error.h"
#include "engine/scene/layers.h"

namespace quadgraph {
namespace {

constexpr std::size_t most_rows = 5;  // that are seen at once

// A button with an eye, which is shut where the layer is hidden; whether it was pressed.
bool draw_eye(bool open) {
  const float side = ImGui::GetTextLineHeight();
  const ImVec2 at = ImGui::GetCursorScreenPos(), size(1.7f * side, ImGui::GetFrameHeight());
  const bool pressed = ImGui::Button("##eye", size);
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", open ? "Hide the layer" : "Show the layer");
  const float x = at.x + 0.5f * size.x, y = at.y + 0.5f * size.y, half = 0.6f * side, line = 0.1f * side;
  const ImU32 colour = ImGui::GetColorU32(open ? ImGuiCol_Text : ImGuiCol_TextDisabled);
  ImDrawList* draw = ImGui::GetWindowDrawList();
  for (const float lid : {-0.7f * side, 0.7f * side}) {
    if (open || lid > 0) draw->AddBezierQuadratic({x - half, y}, {x, y + lid}, {x + half, y}, colour, line);
  }
  if (open) draw->AddCircleFilled({x, y}, 0.2f * side, colour);
  return pressed;
}

// A row of the list; whether it was chosen.
bool draw_row(EditLayer& layer, bool active) {
  const float top = ImGui::GetCursorPosY();
  if (draw_eye(layer.visible)) layer.visible = !layer.visible;
  ImGui::SameLine();
  ImGui::SetCursorPosY(top - ImGui::GetStyle().FramePadding.y);  // level with the eye
  const bool chosen = ImGui::Selectable("##row", active, ImGuiSelectableFlags_None, {0, ImGui::GetFrameHeight()});
  ImGui::SameLine();
  ImGui::SetCursorPosY(top);
  ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(layer.visible ? ImGuiCol_Text : ImGuiCol_TextDisabled));
  ImGui::TextUnformatted(layer.name.c_str());
  ImGui::PopStyleColor();
  ImGui::SetCursorPosY(top + ImGui::GetFrameHeightWithSpacing());
  return chosen;
}

// The topmost layer first.
void draw_list(State& state) {
  auto& layers = state.scene.layers;
  const auto rows = static_cast<float>(std::clamp<std::size_t>(layers.size(), 1, most_rows));
  const float height = rows * ImGui::GetFrameHeightWithSpacing() + 2 * ImGui::GetStyle().WindowPadding.y;
  ImGui::BeginChild("layers", {0, height}, true);
  if (layers.empty()) ImGui::TextDisabled("None yet: the first stroke makes one.");
  for (std::size_t i = layers.size(); i-- > 0;) {
    ImGui::PushID(static_cast<int>(i));
    if (draw_row(layers[i], i == state.layer)) state.layer = i;
    ImGui::PopID();
  }
  ImGui::EndChild();
}

void draw_buttons_of_layers(State& state) {
  Scene& scene = state.scene;
  const bool any = !scene.layers.empty();
  if (button("Add##layer", scene.layers.size() < most_layers, false)) add_layer(scene, state.layer);
  if (button("Remove##layer", any)) remove_layer(scene, state.layer);
  if (button("Up##layer", state.layer + 1 < scene.layers.size())) move_layer(scene, state.layer, true);
  if (button("Down##layer", any && state.layer > 0)) move_layer(scene, state.layer, false);
}

// What is typed is the name once the field is left; one that cannot be a name is said, and leaves the one before.
void draw_name(State& state, EditLayer& layer) {
  if (!state.names_layer) state.layer_text = layer.name;
  ImGui::InputText("Name##layer", &state.layer_text);
  state.names_layer = ImGui::IsItemActive();
  if (!ImGui::IsItemDeactivatedAfterEdit()) return;
  try {
    check_layer({.name = state.layer_text});
    layer.name = state.layer_text;
  } catch (const InputError& error) {
    state.say(error.what(), true);
  }
}

}  // namespace

void draw_layers(State& state) {
  ImGui::TextDisabled("Layers");
  draw_list(state);
  draw_buttons_of_layers(state);
  keep_active(state.scene, state.layer);
  if (state.scene.layers.empty()) return;
  EditLayer& layer = state.scene.layers[state.layer];
  draw_name(state, layer);
  float share = 100 * layer.opacity;
  if (slide("Opacity##layer", share, 0, 100, "%.0f%%")) layer.opacity = std::clamp(share / 100, 0.0f, 1.0f);
  tell("Strokes", formatted("%zu in %s", layer.edits.size(), layer.name.c_str()));
}

}  // namespace quadgraph
