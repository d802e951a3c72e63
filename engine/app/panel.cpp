#include "engine/app/panel.h"

#include <imgui.h>
#include <imgui_stdlib.h>

#include "engine/app/cut_section.h"
#include "engine/app/edit_section.h"
#include "engine/app/environment_section.h"
#include "engine/app/lab_sections.h"
#include "engine/app/light_section.h"
#include "engine/app/look_sections.h"
#include "engine/app/material_section.h"
#include "engine/app/panel_widgets.h"

namespace quadgraph {
namespace {

// What is told of the picture in a line.
std::string state_text(const Measured& measured) {
  if (measured.frame_ms == 0) return "the first picture is being made";
  const auto& error = measured.picture_error ? measured.picture_error : measured.solve.error;
  const bool corrected = measured.solve.correction || measured.solve.carried;
  const std::string off = error && (measured.settled || corrected) ? ", error " + percent(error->whole) : "";
  return (measured.settled ? "converged" : measured.frames > 0 ? "converging" : "preview") + off;
}

void draw_modes(State& state) {
  int lab = state.lab ? 1 : 0;
  ImGui::RadioButton("Look", &lab, 0);
  ImGui::SameLine();
  ImGui::RadioButton("Lab", &lab, 1);
  state.lab = lab == 1;
}

void draw_buttons(State& state) {
  if (button("Save image", true, false)) state.screenshot = true;
  if (button(state.filming ? "Cancel film" : "Save film")) (state.filming ? state.cancel_film : state.save_film) = true;
  if (button("Save scene")) state.save = true;
  if (button("Undo", state.can_undo, false)) state.undo = true;
  if (button("Redo", state.can_redo)) state.redo = true;
  button("Before", state.can_undo);
  state.compares_by_button = ImGui::IsItemActive();
  if (button("Shortcuts")) state.help = !state.help;
  if (button("Full screen")) state.full_screen = true;
  ImGui::Checkbox("Turntable", &state.turntable);
}

void draw_sections(State& state, const PanelFacts& facts) {
  const Sphere& bounds = facts.engine.bounds();
  if (state.lab) {
    tell("Device", facts.engine.device().info().name);
    draw_frame(facts.measured);
    draw_show(state, facts.engine);
  }
  draw_file(state);
  draw_material(state, facts.unit);
  draw_edits(state, bounds);
  draw_lights(state, bounds);
  draw_environment(state, bounds);
  if (state.lab) draw_solver(state);
  if (state.scene.solve.method == Method::shortest_path) draw_cuts(state, bounds);
  draw_shape(state, facts.measured);
  draw_picture(state, facts.measured);
  draw_camera(state, bounds);
  draw_film_choice(state);
  if (state.lab) draw_passes(facts.measured.passes);
}

}  // namespace

void draw_panel(State& state, const PanelFacts& facts) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({0, 0});
  ImGui::SetNextWindowSize({panel_width * facts.unit, size.y});
  if (state.focus_panel) ImGui::SetNextWindowFocus();
  ImGui::Begin("panel", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoFocusOnAppearing);
  ImGui::PushItemWidth(0.62f * ImGui::GetContentRegionAvail().x);
  ImGui::TextUnformatted(state.scene.body.filename().string().c_str());
  ImGui::TextDisabled("%s", state_text(facts.measured).c_str());
  draw_modes(state);
  draw_buttons(state);
  draw_sections(state, facts);
  ImGui::PopItemWidth();
  ImGui::End();
}

}  // namespace quadgraph
