#include "engine/app/look_sections.h"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/app/body_choice.h"
#include "engine/app/panel_widgets.h"

namespace quadgraph {
namespace {

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

// Where the body that is chosen has been put.
void draw_placement(State& state) {
  if (state.body.empty()) return;
  if (const std::string around = moves_with(state); !around.empty()) {
    ImGui::TextDisabled("%s moves with %s, within which it lies", state.body.c_str(), around.c_str());
    return;
  }
  const auto found = state.scene.placements.find(state.body);
  BodyPose pose = found == state.scene.placements.end() ? BodyPose() : found->second;
  glm::vec3 position(pose.position), rotation(pose.rotation);
  ImGui::TextDisabled("%s", state.body.c_str());
  bool changed = false;
  for (int k = 0; k < 3; ++k) {
    const std::string axis(1, "XYZ"[k]);
    changed |= slide(("Move " + axis).c_str(), position[k], -state.reach, state.reach, "%.1f mm");
  }
  for (int k = 0; k < 3; ++k) {
    const std::string axis(1, "XYZ"[k]);
    changed |= slide(("Turn " + axis).c_str(), rotation[k], -180, 180, "%.0f°");
  }
  if (!changed) return;
  pose = {glm::dvec3(position), glm::dvec3(rotation)};
  state.scene.placements[state.body] = pose;
  if (pose == BodyPose()) state.scene.placements.erase(state.body);
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

}  // namespace

// A name that is typed; files can be dropped onto the window as well.
void draw_file(State& state) {
  if (!section("Open", false)) return;
  if (ImGui::InputTextWithHint("File##open", "bunny.qgraph, scene.json, mesh.obj", &state.file_text,
                               ImGuiInputTextFlags_EnterReturnsTrue) &&
      !state.file_text.empty()) {
    state.opening = state.file_text;
  }
  slide("Mesh size", state.longest_mm, 1, 1000, "longest side %.0f mm", true);
}

void draw_shape(State& state, const Measured& measured) {
  if (!section("Shape", false)) return;
  if (const std::string& said = measured.solve.deformed; !said.empty()) ImGui::TextWrapped("%s", said.c_str());
  draw_placement(state);
  draw_deformer(state.scene, "Twist", DeformerKind::twist);
  draw_deformer(state.scene, "Bend", DeformerKind::bend);
  draw_deformer(state.scene, "Taper", DeformerKind::taper);
  draw_deformer(state.scene, "Stretch", DeformerKind::stretch);
}

void draw_picture(State& state, const Measured& measured) {
  if (!section("Picture", false)) return;
  choose("Radiance", state.scene.render.radiance);
  ImGui::Checkbox("Ground", &state.scene.render.ground);
  auto samples = static_cast<int>(state.scene.render.samples);
  if (ImGui::SliderInt("Samples", &samples, 0, 256, samples > 0 ? "%d per pixel" : "as needed")) {
    state.scene.render.samples = static_cast<std::uint32_t>(std::max(samples, 0));
  }
  auto converge = static_cast<float>(100 * state.scene.render.converge);
  if (slide("Converge to", converge, 0, 10, converge > 0 ? "%.1f%%" : "no target")) {
    state.scene.render.converge = converge < 0.1f ? 0 : static_cast<double>(converge) / 100;
  }
  choose("Filter", state.scene.render.filter);
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

// What a film shows that is saved.
void draw_film_choice(State& state) {
  if (!section("Film", false)) return;
  FilmChoice& film = state.film;
  auto of = static_cast<std::size_t>(film.of);
  if (choose("Shows", of, film_names(state.has_frames))) film.of = static_cast<FilmOf>(of);
  if (film.of != FilmOf::frames) {
    for (const int seconds : film_seconds) {
      if (ImGui::RadioButton((std::to_string(seconds) + " s").c_str(), film.seconds == seconds)) film.seconds = seconds;
      ImGui::SameLine();
    }
    ImGui::TextDisabled("for a turn");
  }
  if (ImGui::RadioButton(".mp4", !film.gif)) film.gif = false;
  ImGui::SameLine();
  if (ImGui::RadioButton(".gif", film.gif)) film.gif = true;
}

}  // namespace quadgraph
