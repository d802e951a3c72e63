#include "engine/app/edit_section.h"

#include <imgui.h>
#include <imgui_stdlib.h>

#include "engine/app/layer_section.h"
#include "engine/app/modes.h"
#include "engine/app/panel_widgets.h"
#include "engine/render/light/image_file.h"

namespace quadgraph {
namespace {

// A coefficient that the brush may leave alone.
void draw_coefficient(const char* name, std::optional<glm::vec3>& by, Edit::Operation operation) {
  bool changed = by.has_value();
  ImGui::PushID(name);
  if (ImGui::Checkbox(name, &changed)) by = changed ? std::optional(glm::vec3(1)) : std::nullopt;
  if (by) {
    const bool factor = operation == Edit::Operation::multiply;
    const float least = operation == Edit::Operation::add ? -10.0f : 0.0f;
    ImGui::DragFloat3(factor ? "Factor" : "1/mm", &by->x, 0.01f, least, 100, "%.2f");
  }
  ImGui::PopID();
}

// A field for the name of an image file; an empty name removes the image.
void draw_image(State& state, const char* name, std::shared_ptr<const ImagePyramid>& image) {
  std::string text = image ? image->file.string() : std::string();
  if (!ImGui::InputTextWithHint(name, "image.png, .exr, .hdr", &text, ImGuiInputTextFlags_EnterReturnsTrue)) return;
  try {
    image = text.empty() ? nullptr : load_pyramid(text);
    state.say("");
  } catch (const std::exception& error) {
    state.say(error.what(), true);
  }
}

void draw_tools(Brush& brush) {
  auto tool = static_cast<int>(brush.tool);
  ImGui::RadioButton("Paint##tool", &tool, static_cast<int>(BrushTool::paint));
  ImGui::SameLine();
  ImGui::RadioButton("Erase", &tool, static_cast<int>(BrushTool::erase));
  ImGui::SameLine();
  ImGui::RadioButton("Pick colour", &tool, static_cast<int>(BrushTool::pick));
  brush.tool = static_cast<BrushTool>(tool);
}

void draw_paint(Brush& brush) {
  colour_button("Colour##brush", brush.look.colour);
  slide("Light goes##brush", brush.look.distance, 0.02f, 50, "%.2f mm", true);
  float share = 100 * brush.strength;
  if (slide("Strength", share, 0, 100, "%.0f%%")) brush.strength = share / 100;
}

// What a stroke does where it is said by coefficients.
void draw_coefficients(State& state, const Sphere& bounds) {
  Brush& brush = state.brush;
  bool by_hand = !brush.by_colour;
  if (ImGui::Checkbox("By coefficients", &by_hand)) brush.by_colour = !by_hand;
  slide("Depth from", brush.edit.depth_from, 0, bounds.radius, "%.1f mm");
  draw_image(state, "Pattern", brush.edit.image);
  if (!by_hand) return;
  choose("Operation", brush.edit.operation);
  draw_coefficient("Absorption", brush.edit.sigma_a, brush.edit.operation);
  draw_coefficient("Scattering", brush.edit.sigma_s_prime, brush.edit.operation);
}

void draw_mirror(State& state) {
  const auto names = mirror_names(state.front, state.scene.view.up);
  auto chosen = static_cast<std::size_t>(state.brush.mirror);
  if (choose("Mirror", chosen, {names.begin(), names.end()})) state.brush.mirror = static_cast<Mirror>(chosen);
}

}  // namespace

void draw_edits(State& state, const Sphere& bounds) {
  if (!section("Paint", false)) return;
  Brush& brush = state.brush;
  if (bool on = brush.on; ImGui::Checkbox("Paint with left drag (P)", &on)) take_brush(state, on);
  draw_tools(brush);
  if (brush.by_colour) draw_paint(brush);
  slide("Radius", brush.edit.radius, 0.005f * bounds.radius, 0.5f * bounds.radius, "%.1f mm");
  slide("Depth", brush.edit.depth_to, brush.edit.depth_from + 1e-3f * bounds.radius, 2 * bounds.radius, "%.1f mm");
  slide("Falloff", brush.edit.softness, 0, brush.edit.radius, "%.1f mm");
  draw_image(state, "Mask", brush.edit.mask);
  if (state.lab) draw_coefficients(state, bounds);
  draw_mirror(state);
  draw_layers(state);
}

}  // namespace quadgraph
