#include "engine/app/edit_section.h"

#include <imgui.h>
#include <imgui_stdlib.h>

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

}  // namespace

void draw_edits(State& state, const Sphere& bounds) {
  if (!section("Edit", false)) return;
  if (ImGui::Button("Undo") && state.can_undo) state.undo = true;
  ImGui::SameLine();
  if (ImGui::Button("Redo") && state.can_redo) state.redo = true;
  ImGui::SameLine();
  if (ImGui::Button("Save scene")) state.save = true;
  Edit& edit = state.brush.edit;
  if (bool on = state.brush.on; ImGui::Checkbox("Paint with left drag", &on)) take_brush(state, on);
  choose("Operation", edit.operation);
  draw_coefficient("Absorption", edit.sigma_a, edit.operation);
  draw_coefficient("Scattering", edit.sigma_s_prime, edit.operation);
  draw_image(state, "Pattern", edit.image);
  draw_image(state, "Mask", edit.mask);
  slide("Radius", edit.radius, 0.005f * bounds.radius, 0.5f * bounds.radius, "%.1f mm");
  slide("Depth from", edit.depth_from, 0, bounds.radius, "%.1f mm");
  slide("Depth to", edit.depth_to, edit.depth_from + 1e-3f * bounds.radius, 2 * bounds.radius, "%.1f mm");
  slide("Softness", edit.softness, 0, edit.radius, "%.1f mm");
  tell("Edits", formatted("%zu", state.scene.edits.size()));
}

}  // namespace quadgraph
