#include "engine/app/panel.h"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/app/commands.h"
#include "engine/app/gestures.h"
#include "engine/app/panel_widgets.h"
#include "engine/graph/material.h"
#include "engine/render/default_lights.h"
#include "engine/render/legend.h"
#include "engine/scene/volume.h"
#include "shaders/colour_map.h"

namespace quadgraph {
namespace {

bool section(const char* name, bool open = true) {
  return ImGui::CollapsingHeader(name, open ? ImGuiTreeNodeFlags_DefaultOpen : ImGuiTreeNodeFlags_None);
}

void draw_plane(Show& show, const Sphere& bounds) {
  for (int axis = 0; axis < 3; ++axis) {
    if (axis > 0) ImGui::SameLine();
    ImGui::RadioButton(std::array{"x", "y", "z"}[static_cast<std::size_t>(axis)], &show.axis, axis);
  }
  slide("plane", show.offset, -bounds.radius, bounds.radius, "%.1f mm");
}

void draw_show(State& state, const Engine& engine) {
  if (!section("View")) return;
  Show& show = state.scene.render.show;
  choose("show", show.quantity, std::to_array(quantities));
  if (has_plane(show.quantity)) draw_plane(show, engine.bounds());
  if (has_level(show.quantity)) {
    auto level = static_cast<int>(show.level);
    const auto last = static_cast<int>(engine.graph().levels().size()) - 1;
    if (ImGui::SliderInt("level", &level, 0, last)) show.level = static_cast<std::uint32_t>(level);
  }
  if (show.quantity == Quantity::difference) {
    choose("other method", show.other, std::array{Method::fem, Method::quadgraph_fv, Method::quadgraph_fdm});
  }
}

void draw_material(State& state) {
  if (!section("Material")) return;
  const auto& names = material_names();
  const auto found = std::find(names.begin(), names.end(), state.scene.material);
  const char* shown = found == names.end() ? "its own numbers" : found->c_str();
  if (ImGui::BeginCombo("material", shown, ImGuiComboFlags_HeightLarge)) {
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
      if (!is_volume(state.material_text)) parse_material(state.material_text);
      state.scene.material = state.material_text;
      state.say("");
    } catch (const std::exception& error) {
      state.say(error.what(), true);
    }
  }
  ImGui::PopItemWidth();
}

// A coefficient that the brush may leave alone.
void draw_coefficient(const char* name, std::optional<glm::vec3>& by, Edit::Operation operation) {
  bool changed = by.has_value();
  ImGui::PushID(name);
  if (ImGui::Checkbox(name, &changed)) by = changed ? std::optional(glm::vec3(1)) : std::nullopt;
  if (by) {
    const bool factor = operation == Edit::Operation::multiply;
    const float least = operation == Edit::Operation::add ? -10.0f : 0.0f;
    ImGui::DragFloat3(factor ? "times" : "1/mm", &by->x, 0.01f, least, 100, "%.2f");
  }
  ImGui::PopID();
}

void draw_edits(State& state, const Sphere& bounds) {
  if (!section("Edit", false)) return;
  if (ImGui::Button("undo") && state.can_undo) state.undo = true;
  ImGui::SameLine();
  if (ImGui::Button("redo") && state.can_redo) state.redo = true;
  ImGui::SameLine();
  if (ImGui::Button("scene to file")) state.save = true;
  Edit& edit = state.brush.edit;
  ImGui::Checkbox("a left drag paints", &state.brush.on);
  constexpr std::array<const char*, 3> names = {"multiply", "add", "set"};
  auto operation = static_cast<int>(edit.operation);
  if (ImGui::Combo("operation", &operation, names.data(), 3)) edit.operation = static_cast<Edit::Operation>(operation);
  draw_coefficient("absorption", edit.sigma_a, edit.operation);
  draw_coefficient("scattering", edit.sigma_s_prime, edit.operation);
  slide("radius", edit.radius, 0.005f * bounds.radius, 0.5f * bounds.radius, "%.1f mm");
  slide("from depth", edit.depth_from, 0, bounds.radius, "%.1f mm");
  slide("to depth", edit.depth_to, edit.depth_from + 1e-3f * bounds.radius, 2 * bounds.radius, "%.1f mm");
  slide("softness", edit.softness, 0, edit.radius, "%.1f mm");
  tell("strokes", formatted("%zu", state.scene.edits.size()));
}

// Brightness and tint of a light whose numbers span many decades.
void draw_power(Light& light, const char* unit) {
  float most = std::max({light.power.x, light.power.y, light.power.z, 1e-9f});
  glm::vec3 tint = light.power / most;
  // A text without a conversion: the slider moves along decades and tells the power.
  const std::string told = formatted("%.3g ", static_cast<double>(most)) + unit;
  float decades = std::log10(most);
  if (slide("power", decades, -6,
            light.kind == LightKind::directional || light.kind == LightKind::ambient ? 1.0f : 6.0f, told.c_str())) {
    most = std::pow(10.0f, decades);
    light.power = most * tint;
  }
  if (ImGui::ColorEdit3("tint", &tint.x, ImGuiColorEditFlags_Float | ImGuiColorEditFlags_NoInputs)) {
    light.power = most * tint;
  }
}

void draw_bearing(Light& light, UpAxis up) {
  Bearing bearing = bearing_of(-light.direction, up);
  const bool around = slide("from, around", bearing.azimuth, -180, 180, "%.0f°");
  const bool above = slide("from above", bearing.elevation, -89.9f, 89.9f, "%.0f°");
  if (around || above) light.direction = -towards(bearing, up);
}

// A projector needs an image, which a scene file names.
void draw_kind(Light& light, const Sphere& bounds) {
  constexpr std::array kinds = {LightKind::directional, LightKind::point, LightKind::ambient, LightKind::spot,
                                LightKind::rectangle};
  const auto found = std::find(kinds.begin(), kinds.end(), light.kind);
  if (found == kinds.end()) return;
  auto chosen = static_cast<std::size_t>(found - kinds.begin());
  const auto name = [](std::size_t i) {
    constexpr std::string_view names[] = {"directional", "point", "ambient", "spot", "rectangle"};
    return names[i];
  };
  if (choose("kind", chosen, name, kinds.size())) light = as_kind(light, kinds[chosen], bounds);
}

void draw_light(State& state, const Sphere& bounds) {
  Light& light = state.scene.lights[state.light];
  draw_kind(light, bounds);
  switch (light.kind) {
    case LightKind::directional:
      draw_bearing(light, state.scene.view.up);
      return draw_power(light, "W/mm²");
    case LightKind::ambient:
      return draw_power(light, "W/mm²");
    case LightKind::spot:
    case LightKind::projector:
      draw_bearing(light, state.scene.view.up);
      slide("angle##light", light.angle, 1, light.kind == LightKind::spot ? 90 : 160, "%.0f°");
      break;
    case LightKind::environment:
      slide("turn##light", light.turn, -180, 180, "%.0f°");
      return draw_power(light, "W/(mm² sr)");
    default:
      break;
  }
  ImGui::DragFloat3("at, mm", &light.position.x, 0.01f * bounds.radius, 0, 0, "%.1f");
  draw_power(light, "W");
}

void draw_lights(State& state, const Sphere& bounds) {
  if (!section("Lights")) return;
  auto& lights = state.scene.lights;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    ImGui::PushID(static_cast<int>(i));
    const std::string text = to_string(lights[i]);
    const std::string name = formatted("%zu  %s", i + 1, text.substr(0, text.find(':')).c_str());
    if (ImGui::RadioButton(name.c_str(), state.light == i)) state.light = i;
    ImGui::PopID();
  }
  if (state.light < lights.size()) draw_light(state, bounds);
  if (ImGui::Button("add")) {
    lights.push_back(default_lights(state.scene.view).front());
    state.light = lights.size() - 1;
  }
  ImGui::SameLine();
  if (ImGui::Button("remove") && state.light < lights.size()) {
    lights.erase(lights.begin() + static_cast<std::ptrdiff_t>(state.light));
    state.light = lights.empty() ? 0 : std::min(state.light, lights.size() - 1);
  }
}

// A slider over the deformer of a kind, which is in the list while it does something.
void draw_deformer(Scene& scene, const char* label, DeformerKind kind) {
  const bool turns = kind == DeformerKind::twist || kind == DeformerKind::bend;
  auto& list = scene.deformation;
  auto found = std::find_if(list.begin(), list.end(), [&](const Deformer& d) { return d.kind == kind; });
  const double neutral = turns ? 0 : 1;
  auto value = static_cast<float>(found == list.end() ? neutral : turns ? found->degrees : found->factor);
  if (!slide(label, value, turns ? -180.0f : 0.4f, turns ? 180.0f : 2.0f, turns ? "%.0f°" : "%.2f times")) return;
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
  draw_deformer(state.scene, "twist", DeformerKind::twist);
  draw_deformer(state.scene, "bend", DeformerKind::bend);
  draw_deformer(state.scene, "taper", DeformerKind::taper);
  draw_deformer(state.scene, "stretch", DeformerKind::stretch);
}

void draw_solver(State& state) {
  if (!section("Solve")) return;
  SolveOptions& solve = state.scene.solve;
  choose("method", solve.method, std::array{Method::fem, Method::quadgraph_fv, Method::quadgraph_fdm});
  choose("solver", solve.solver,
         std::array{SolverKind::fmg_pcg, SolverKind::vcycle, SolverKind::dpcg, SolverKind::cascade, SolverKind::jacobi,
                    SolverKind::automatic});
  choose("source", solve.source, std::array{Source::buried, Source::diffuse});
  choose("model", solve.model, std::array{Model::automatic, Model::diffusion, Model::sp3});
  auto error = static_cast<float>(100 * solve.error);
  if (slide("error", error, 0, 20, error > 0 ? "at most %.1f%%" : "no target")) {
    solve.error = error < 0.1f ? 0 : static_cast<double>(error) / 100;
  }
  ImGui::Checkbox("light from part to part", &solve.inter_reflection);
}

void draw_picture(State& state, const Measured& measured) {
  if (!section("Picture", false)) return;
  choose("radiance", state.scene.render.radiance,
         std::array{Radiance::automatic, Radiance::gathered, Radiance::lambertian});
  ImGui::Checkbox("ground", &state.scene.render.ground);
  slide("roughness", state.scene.render.roughness, 0.02f, 1, "%.2f");
  auto& stops = state.scene.tone.exposure_stops;
  bool automatic = !stops;
  if (ImGui::Checkbox("exposure by itself", &automatic)) {
    stops = automatic ? std::nullopt : std::optional(measured.exposure_stops);
  }
  float value = stops.value_or(measured.exposure_stops);
  if (slide("exposure", value, -20, 20, "%+.1f stops")) stops = value;
  ImGui::ColorEdit3("above", &state.scene.tone.background_top.x, ImGuiColorEditFlags_Float);
  ImGui::ColorEdit3("below", &state.scene.tone.background_bottom.x, ImGuiColorEditFlags_Float);
}

void draw_camera(State& state, const Sphere& bounds) {
  if (!section("Camera", false)) return;
  View& view = state.scene.view;
  slide("around", view.azimuth, -180, 180, "%.0f°");
  slide("above##camera", view.elevation, -90, 90, "%.0f°");
  slide("angle", view.vertical_fov, 5, 90, "%.0f°");
  float distance = view.distance.value_or(0);
  const char* format = view.distance ? "%.0f mm" : "the whole object";
  if (slide("distance", distance, 0, 20 * bounds.radius, format)) {
    view.distance = distance > 0.05f * bounds.radius ? std::optional(distance) : std::nullopt;
  }
}

void draw_passes(const std::vector<PassStats>& passes) {
  if (!section("Milliseconds by pass")) return;
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

std::string error_text(const SolveReport& report) {
  if (!report.error) return "not known, a single level";
  const std::string unlit = report.error->unlit > 0 ? percent(report.error->unlit) : "–";
  return percent(report.error->whole) + " whole, " + unlit + " unlit";
}

void draw_frame(const Measured& measured) {
  if (!section("Frame")) return;
  const SolveReport& report = measured.solve;
  const glm::dvec3 balance = report.energy.balance();
  const double worst = std::max({std::abs(balance.x), std::abs(balance.y), std::abs(balance.z)});
  tell("picture", formatted("%.0f ms, %.1f per second", measured.frame_ms, measured.frames_per_second));
  tell("state",
       measured.settled ? "converged" : formatted("in motion, at %.0f%% of the size", 100.0 * double(measured.share)));
  tell("error", error_text(report));
  tell("energy", "balanced to " + percent(worst));
  tell("memory", bytes_text(measured.device_bytes) + ", at most " + bytes_text(measured.peak_device_bytes));
  if (!report.levels.empty()) {
    const LevelReport& last = report.levels.back();
    tell("solved", formatted("%u unknowns, %u cycles", last.unknowns, last.iterations));
    tell("with", std::string(name_of(report.model)) + ", " + std::string(name_of(report.solver)));
  }
  for (const std::string& text : {report.replaced, report.missed, report.mesh_warning, report.model_warning}) {
    if (!text.empty()) ImGui::TextWrapped("%s", text.c_str());
  }
}

void draw_buttons(State& state) {
  if (ImGui::Button("picture to file")) state.screenshot = true;
  ImGui::SameLine();
  if (ImGui::Button("full screen")) state.full_screen = true;
  ImGui::SameLine();
  if (ImGui::Button("keys")) state.help = !state.help;
}

}  // namespace

void draw_panel(State& state, const PanelFacts& facts) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({0, 0});
  ImGui::SetNextWindowSize({panel_width * facts.unit, size.y});
  if (state.focus_panel) ImGui::SetNextWindowFocus();
  ImGui::Begin("panel", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoBringToFrontOnFocus);
  ImGui::PushItemWidth(0.62f * ImGui::GetContentRegionAvail().x);
  ImGui::TextUnformatted(state.scene.body.filename().string().c_str());
  ImGui::TextDisabled("%s", facts.engine.context().info().name.c_str());
  draw_buttons(state);
  draw_frame(facts.measured);
  draw_show(state, facts.engine);
  draw_material(state);
  draw_edits(state, facts.engine.bounds());
  draw_lights(state, facts.engine.bounds());
  draw_solver(state);
  draw_shape(state);
  draw_picture(state, facts.measured);
  draw_camera(state, facts.engine.bounds());
  draw_passes(facts.measured.passes);
  ImGui::PopItemWidth();
  ImGui::End();
}

void draw_help(State& state, float unit) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({0.5f * size.x, 0.5f * size.y}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowBgAlpha(0.94f);
  ImGui::Begin("keys", &state.help,
               ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoNav |
                   ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoMove);
  ImGui::TextUnformatted("Left drag turns the object, right or middle drag moves it, the wheel brings it nearer.");
  ImGui::TextUnformatted(
      "With Ctrl or Shift a drag turns the selected light; with the brush in hand a left drag paints.");
  ImGui::Separator();
  const auto commands = all_commands();
  const std::size_t rows = (commands.size() + 1) / 2;
  if (ImGui::BeginTable("table", 4, ImGuiTableFlags_SizingFixedFit)) {
    for (std::size_t row = 0; row < rows; ++row) {
      ImGui::TableNextRow();
      for (std::size_t i = row; i < commands.size(); i += rows) {
        ImGui::TableNextColumn();
        ImGui::TextColored({0.95f, 0.65f, 0.32f, 1}, "%.*s", static_cast<int>(commands[i].keys.size()),
                           commands[i].keys.data());
        ImGui::TableNextColumn();
        ImGui::Text("%.*s   ", static_cast<int>(commands[i].text.size()), commands[i].text.data());
      }
    }
    ImGui::EndTable();
  }
  ImGui::Dummy({560 * unit, 0});
  ImGui::End();
}

void draw_colour_bar(const Legend& legend, float left, float unit) {
  constexpr int strips = 96;
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  const float width = std::min(360 * unit, size.x - left - 60 * unit);
  if (width < 100 * unit) return;
  ImGui::SetNextWindowPos({size.x - 12 * unit, size.y - 12 * unit}, ImGuiCond_Always, {1, 1});
  ImGui::SetNextWindowBgAlpha(0.75f);
  ImGui::Begin("colours", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoInputs |
                   ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoFocusOnAppearing);
  ImGui::Text("%s, %s", legend.title.c_str(), legend.unit.c_str());
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImDrawList* draw = ImGui::GetWindowDrawList();
  for (int i = 0; i < strips; ++i) {
    const glm::vec3 linear = gpu::mapped_colour((static_cast<float>(i) + 0.5f) / strips, legend.diverging ? 1 : 0);
    const ImU32 colour = ImGui::GetColorU32({srgb_encode(linear.x), srgb_encode(linear.y), srgb_encode(linear.z), 1});
    draw->AddRectFilled({at.x + width * static_cast<float>(i) / strips, at.y},
                        {at.x + width * static_cast<float>(i + 1) / strips + 1, at.y + 14 * unit}, colour);
  }
  const ImU32 text = ImGui::GetColorU32(ImGuiCol_Text);
  for (const Tick& tick : ticks_of(legend)) {
    const float x = at.x + tick.place * width;
    draw->AddLine({x, at.y + 14 * unit}, {x, at.y + 18 * unit}, text);
    const float half = 0.5f * ImGui::CalcTextSize(tick.text.c_str()).x;
    draw->AddText({std::clamp(x - half, at.x, at.x + width - 2 * half), at.y + 19 * unit}, text, tick.text.c_str());
  }
  ImGui::Dummy({width, 22 * unit + ImGui::GetTextLineHeight()});
  ImGui::End();
}

void draw_message(const State& state, float left, float unit) {
  if (state.message.empty()) return;
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({left + 12 * unit, size.y - 12 * unit}, ImGuiCond_Always, {0, 1});
  ImGui::SetNextWindowSizeConstraints({0, 0}, {size.x - left - 24 * unit, size.y});
  ImGui::SetNextWindowBgAlpha(0.85f);
  ImGui::Begin("message", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoInputs |
                   ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoFocusOnAppearing);
  ImGui::PushTextWrapPos(size.x - left - 48 * unit);
  const ImVec4 colour = state.refused ? ImVec4(1, 0.55f, 0.45f, 1) : ImVec4(0.9f, 0.9f, 0.89f, 1);
  ImGui::PushStyleColor(ImGuiCol_Text, colour);
  ImGui::TextUnformatted(state.message.c_str());
  ImGui::PopStyleColor();
  ImGui::PopTextWrapPos();
  ImGui::End();
}

}  // namespace quadgraph
