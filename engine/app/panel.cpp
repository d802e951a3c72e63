#include "engine/app/panel.h"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/app/cut_section.h"
#include "engine/app/edit_section.h"
#include "engine/app/light_section.h"
#include "engine/app/panel_widgets.h"
#include "engine/optics/material.h"
#include "engine/scene/volume.h"

namespace quadgraph {
namespace {

void draw_plane(Show& show, const Sphere& bounds) {
  for (int axis = 0; axis < 3; ++axis) {
    if (axis > 0) ImGui::SameLine();
    ImGui::RadioButton(std::array{"x", "y", "z"}[static_cast<std::size_t>(axis)], &show.axis, axis);
  }
  slide("Plane offset", show.offset, -bounds.radius, bounds.radius, "%.1f mm");
}

void draw_show(State& state, const Engine& engine) {
  if (!section("View")) return;
  Show& show = state.scene.render.show;
  choose("Show", show.quantity);
  if (has_plane(show.quantity)) draw_plane(show, engine.bounds());
  if (has_level(show.quantity)) {
    auto level = static_cast<int>(show.level);
    const auto last = static_cast<int>(engine.graph().levels().size()) - 1;
    if (ImGui::SliderInt("Level", &level, 0, last)) show.level = static_cast<std::uint32_t>(level);
  }
  if (show.quantity == Quantity::difference) {
    choose("Compare with", show.other, state.methods);
  }
}

void draw_material(State& state) {
  if (!section("Material")) return;
  const auto& names = material_names();
  const auto found = std::find(names.begin(), names.end(), state.scene.material);
  const char* shown = found == names.end() ? "Custom" : found->c_str();
  if (ImGui::BeginCombo("Preset", shown, ImGuiComboFlags_HeightLarge)) {
    for (const std::string& name : names) {
      const bool chosen = name == state.scene.material;
      if (ImGui::Selectable(name.c_str(), chosen)) state.scene.material = name;
      if (chosen) ImGui::SetItemDefaultFocus();
    }
    ImGui::EndCombo();
  }
  if (!ImGui::IsAnyItemActive()) state.material_text = state.scene.material;
  ImGui::PushItemWidth(-1);
  if (ImGui::InputTextWithHint("##text", "marble,sigma_a=.01/.02/.05", &state.material_text,
                               ImGuiInputTextFlags_EnterReturnsTrue)) {
    try {
      check_material_text(state.material_text);
      state.scene.material = state.material_text;
      state.say("");
    } catch (const std::exception& error) {
      state.say(error.what(), true);
    }
  }
  ImGui::PopItemWidth();
}

// A slider over the deformer of a kind, which is in the list while it does something.
void draw_deformer(Scene& scene, const char* label, DeformerKind kind) {
  const bool turns = kind == DeformerKind::twist || kind == DeformerKind::bend;
  auto& list = scene.deformation;
  auto found = std::find_if(list.begin(), list.end(), [&](const Deformer& d) { return d.kind == kind; });
  const double neutral = turns ? 0 : 1;
  auto value = static_cast<float>(found == list.end() ? neutral : turns ? found->degrees : found->factor);
  if (!slide(label, value, turns ? -180.0f : 0.4f, turns ? 180.0f : 2.0f, turns ? "%.0f°" : "× %.2f")) return;
  if (found == list.end()) {
    Deformer fresh{.kind = kind};
    if (scene.view.up == UpAxis::z) fresh.axis = {0, 0, 1};
    found = list.insert(list.end(), fresh);
  }
  (turns ? found->degrees : found->factor) = static_cast<double>(value);
  if (std::abs(static_cast<double>(value) - neutral) < (turns ? 0.5 : 0.005)) list.erase(found);
}

void draw_shape(State& state) {
  if (!section("Shape", false)) return;
  draw_deformer(state.scene, "Twist", DeformerKind::twist);
  draw_deformer(state.scene, "Bend", DeformerKind::bend);
  draw_deformer(state.scene, "Taper", DeformerKind::taper);
  draw_deformer(state.scene, "Stretch", DeformerKind::stretch);
}

void draw_path(PathOptions& path) {
  choose("Cost", path.cost);
  choose("Solver##path", path.solver);
  auto cells = static_cast<int>(path.cells);
  if (ImGui::SliderInt("Voxels", &cells, 16, static_cast<int>(path_cells_range.high)))
    path.cells = static_cast<std::uint32_t>(cells);
}

void draw_solver(State& state) {
  if (!section("Solver")) return;
  SolveOptions& solve = state.scene.solve;
  if (choose("Method", solve.method, state.all_methods()) && !on_grid(solve.method)) solve.active_layers = 0;
  if (solve.method == Method::shortest_path) return draw_path(solve.path);
  choose("Solver##linear", solve.solver);
  choose("Source", solve.source);
  choose("Model", solve.model);
  auto error = static_cast<float>(100 * solve.error);
  if (slide("Error target", error, 0, 20, error > 0 ? "%.1f%%" : "none")) {
    solve.error = error < 0.1f ? 0 : static_cast<double>(error) / 100;
  }
  ImGui::Checkbox("Inter-reflection", &solve.inter_reflection);
  ImGui::Checkbox("Transport correction", &solve.correction);
}

void draw_picture(State& state, const Measured& measured) {
  if (!section("Render", false)) return;
  choose("Radiance", state.scene.render.radiance);
  ImGui::Checkbox("Ground", &state.scene.render.ground);
  ImGui::SameLine();
  ImGui::Checkbox("Show environment", &state.scene.render.surroundings);
  auto& asked = state.scene.render.roughness;
  float roughness = asked.value_or(stated_roughness(state.scene.material).value_or(default_roughness));
  if (slide("Roughness", roughness, roughness_range, "%.2f")) asked = roughness;
  auto samples = static_cast<int>(state.scene.render.samples);
  if (ImGui::SliderInt("Samples", &samples, 0, 256, samples > 0 ? "%d per pixel" : "as needed")) {
    state.scene.render.samples = static_cast<std::uint32_t>(std::max(samples, 0));
  }
  auto converge = static_cast<float>(100 * state.scene.render.converge);
  if (slide("Converge to", converge, 0, 10, converge > 0 ? "%.1f%%" : "no target")) {
    state.scene.render.converge = converge < 0.1f ? 0 : static_cast<double>(converge) / 100;
  }
  choose("Tone", state.scene.tone.curve);
  slide("White balance", state.scene.tone.white_balance, 2000, 12000, "%.0f K");
  auto& stops = state.scene.tone.exposure_stops;
  bool automatic = !stops;
  if (ImGui::Checkbox("Auto exposure", &automatic)) {
    stops = automatic ? std::nullopt : std::optional(measured.exposure_stops);
  }
  float value = stops.value_or(measured.exposure_stops);
  if (slide("Exposure", value, -20, 20, "%+.1f stops")) stops = value;
  ImGui::TextDisabled("Background");
  ImGui::ColorEdit3("Top", &state.scene.tone.background_top.x, ImGuiColorEditFlags_Float);
  ImGui::ColorEdit3("Bottom", &state.scene.tone.background_bottom.x, ImGuiColorEditFlags_Float);
}

// The sliders of a perspective view.
void draw_perspective(View& view, const Sphere& bounds) {
  slide("Field of view", view.vertical_fov, 5, 90, "%.0f°");
  float distance = view.distance.value_or(0);
  const char* format = view.distance ? "%.0f mm" : "fit object";
  if (slide("Distance", distance, 0, 20 * bounds.radius, format)) {
    view.distance = distance > 0.05f * bounds.radius ? std::optional(distance) : std::nullopt;
  }
  slide("Aperture", view.aperture, 0, bounds.radius, view.aperture > 0 ? "%.1f mm" : "all is sharp");
  if (view.aperture <= 0) return;
  float focus = view.focus.value_or(0);
  if (slide("Focus", focus, 0, 20 * bounds.radius, view.focus ? "%.0f mm" : "nearest")) {
    view.focus = focus > 0.05f * bounds.radius ? std::optional(focus) : std::nullopt;
  }
}

void draw_camera(State& state, const Sphere& bounds) {
  if (!section("Camera", false)) return;
  const View shown = by_angles(state.scene.view, bounds);
  View view = shown;
  slide("Azimuth##camera", view.azimuth, -180, 180, "%.0f°");
  slide("Elevation##camera", view.elevation, elevation_range, "%.0f°");
  bool parallel = view.orthographic.has_value();
  if (ImGui::Checkbox("Orthographic", &parallel)) {
    view.orthographic = parallel ? std::optional(0.0f) : std::nullopt;
    view.aperture = 0;
  }
  if (view.orthographic) {
    const char* format = *view.orthographic > 0 ? "%.0f mm" : "fit object";
    slide("Height##camera", *view.orthographic, 0, 10 * bounds.radius, format);
  } else {
    draw_perspective(view, bounds);
  }
  if (view != shown) state.scene.view = view;
}

void draw_passes(const std::vector<PassStats>& passes) {
  if (!section("Time by pass, ms")) return;
  if (!ImGui::BeginTable("passes", 3, ImGuiTableFlags_SizingStretchProp)) return;
  ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthStretch, 3);
  ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthStretch, 2.5f);
  ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthStretch, 1);
  double most = 1e-6;
  for (const PassStats& pass : passes) most = std::max(most, pass.time_ms);
  std::vector<PassStats> sorted = passes;
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.time_ms > b.time_ms; });
  for (const PassStats& pass : sorted) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(pass.name.c_str());
    ImGui::TableNextColumn();
    ImGui::ProgressBar(static_cast<float>(pass.time_ms / most), {-1, ImGui::GetTextLineHeight()}, "");
    ImGui::TableNextColumn();
    ImGui::Text("%.1f", pass.time_ms);
  }
  ImGui::EndTable();
}

// A row of cells under `name`.
void tell_row(const char* name, const std::array<std::string, 3>& cells) {
  ImGui::TextDisabled("%s", name);
  const float width = ImGui::GetContentRegionMax().x;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    ImGui::SameLine((0.26f + 0.22f * static_cast<float>(i)) * width);
    ImGui::TextUnformatted(cells[i].c_str());
  }
}

void tell_error(const char* name, const std::optional<ErrorEstimate>& error) {
  if (!error) return tell(name, "not known");
  const auto part = [](double share) { return share > 0 ? percent(share) : std::string("–"); };
  tell_row(name, {percent(error->whole), part(error->unlit), part(error->dimmest)});
}

void tell_errors(const SolveReport& report, const std::optional<ErrorEstimate>& picture) {
  if (report.path) return tell("Error", "not estimated");
  tell_row("Error", {"whole", "unlit", "dimmest third"});
  tell_error("  all", report.error);
  tell_error("  mesh", report.mesh_error);
  tell_error("  solver", report.algebraic);
  if (!report.correction) {
    tell("  model", "not known without correction");
    return tell("  light", "not known without correction");
  }
  tell_error("  model", report.model_error);
  tell_error("  light", report.light_error);
  tell_error("Picture", picture);
}

void draw_frame(const Measured& measured) {
  if (!section("Frame")) return;
  if (measured.frame_ms == 0) return tell("State", "the first picture is being made");
  const SolveReport& report = measured.solve;
  const glm::dvec3 balance = report.energy.balance();
  const double worst = std::max({std::abs(balance.x), std::abs(balance.y), std::abs(balance.z)});
  tell("Time", formatted("%.0f ms, %.1f fps", measured.frame_ms, measured.frames_per_second));
  tell("State", measured.settled      ? "converged"
                : measured.frames > 0 ? formatted("%u of %u samples", 4 * measured.frames, 4 * measured.frames_wanted)
                                      : formatted("preview, %.0f%% resolution", 100.0 * double(measured.share)));
  tell_errors(report, measured.picture_error);
  tell("Energy", report.path ? "not conserved" : "balanced to " + percent(worst));
  tell("Memory", bytes_text(measured.device_bytes) + ", peak " + bytes_text(measured.peak_device_bytes));
  if (!report.levels.empty()) {
    const LevelReport& last = report.levels.back();
    tell("Solve", formatted("%u unknowns, %u cycles", last.unknowns, last.iterations));
    tell("Solver", std::string(name_of(report.model)) + ", " + std::string(name_of(report.solver)));
  }
  if (report.path) tell("Solve", formatted("%u voxels, %u rounds", report.path->solid, report.path->rounds));
  for (const std::string& text :
       {report.budget, report.replaced, report.missed, report.stopped, report.advice, report.mesh_warning,
        report.model_warning, report.size_warning, report.light_warning}) {
    if (!text.empty()) ImGui::TextWrapped("%s", text.c_str());
  }
}

void draw_buttons(State& state) {
  if (ImGui::Button("Save image")) state.screenshot = true;
  ImGui::SameLine();
  if (ImGui::Button("Full screen")) state.full_screen = true;
  ImGui::SameLine();
  if (ImGui::Button("Shortcuts")) state.help = !state.help;
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
  ImGui::TextDisabled("%s", facts.engine.device().info().name.c_str());
  draw_buttons(state);
  draw_frame(facts.measured);
  draw_show(state, facts.engine);
  draw_material(state);
  draw_edits(state, facts.engine.bounds());
  draw_lights(state, facts.engine.bounds());
  draw_solver(state);
  if (state.scene.solve.method == Method::shortest_path) draw_cuts(state, facts.engine.bounds());
  draw_shape(state);
  draw_picture(state, facts.measured);
  draw_camera(state, facts.engine.bounds());
  draw_passes(facts.measured.passes);
  ImGui::PopItemWidth();
  ImGui::End();
}

}  // namespace quadgraph
