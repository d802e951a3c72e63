#include "engine/app/light_section.h"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "engine/app/gestures.h"
#include "engine/app/panel_widgets.h"
#include "engine/render/light/default_lights.h"

namespace quadgraph {
namespace {

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

// Whether it was changed.
bool draw_bearing(glm::vec3& direction, UpAxis up) {
  Bearing bearing = bearing_of(-direction, up);
  const bool around = slide("from, around", bearing.azimuth, -180, 180, "%.0f°");
  const bool above = slide("from above", bearing.elevation, -89.9f, 89.9f, "%.0f°");
  if (!around && !above) return false;
  direction = -towards(bearing, up);
  return true;
}

bool has_image(LightKind kind) {
  return kind == LightKind::projector || kind == LightKind::environment;
}

// A light that needs an image becomes one when that has been typed.
void draw_kind(State& state, Light& light, const Sphere& bounds) {
  constexpr std::array kinds = {LightKind::directional, LightKind::point,     LightKind::ambient,    LightKind::spot,
                                LightKind::rectangle,   LightKind::projector, LightKind::environment};
  const LightKind shown = state.kind_with_image.value_or(light.kind);
  auto chosen = static_cast<std::size_t>(std::find(kinds.begin(), kinds.end(), shown) - kinds.begin());
  const auto name = [](std::size_t i) {
    constexpr std::string_view names[] = {"directional", "point",     "ambient",    "spot",
                                          "rectangle",   "projector", "environment"};
    return names[i];
  };
  if (!choose("kind", chosen, name, kinds.size())) return;
  state.kind_with_image.reset();
  if (kinds[chosen] == light.kind) return;
  if (has_image(kinds[chosen])) {
    state.kind_with_image = kinds[chosen];
  } else {
    light = as_kind(light, kinds[chosen], bounds);
  }
}

// What is no image the viewer tells when it shows the scene, and takes back.
void draw_image(State& state, Light& light, const Sphere& bounds) {
  if (!state.kind_with_image && !has_image(light.kind)) return;
  if (!ImGui::IsAnyItemActive()) state.image_text = state.kind_with_image ? std::string() : light.file;
  if (!ImGui::InputTextWithHint("image", "picture.png, .exr, .hdr", &state.image_text,
                                ImGuiInputTextFlags_EnterReturnsTrue)) {
    return;
  }
  if (state.kind_with_image) light = as_kind(light, *state.kind_with_image, bounds);
  state.kind_with_image.reset();
  light.file = state.image_text;
  state.say("");
}

void draw_edges(Light& light, const Sphere& bounds, UpAxis up) {
  glm::vec3 direction = glm::normalize(glm::cross(light.u, light.v));
  if (draw_bearing(direction, up)) light = faced(light, direction, up);
  const auto draw_edge = [&](const char* name, glm::vec3& edge) {
    float length = glm::length(edge);
    const glm::vec3 unit = edge / length;
    if (slide(name, length, 0.02f * bounds.radius, 4 * bounds.radius, "%.1f mm")) edge = length * unit;
  };
  draw_edge("width", light.u);
  draw_edge("height", light.v);
}

void draw_light(State& state, const Sphere& bounds) {
  Light& light = state.scene.lights[state.light];
  const UpAxis up = state.scene.view.up;
  draw_kind(state, light, bounds);
  draw_image(state, light, bounds);
  switch (light.kind) {
    case LightKind::directional:
      draw_bearing(light.direction, up);
      return draw_power(light, "W/mm²");
    case LightKind::ambient:
      return draw_power(light, "W/mm²");
    case LightKind::spot:
    case LightKind::projector:
      draw_bearing(light.direction, up);
      slide("angle##light", light.angle, 1, light.kind == LightKind::spot ? 90 : 160, "%.0f°");
      break;
    case LightKind::rectangle:
      draw_edges(light, bounds, up);
      break;
    case LightKind::environment:
      slide("turn##light", light.turn, -180, 180, "%.0f°");
      return draw_power(light, "W/(mm² sr)");
    case LightKind::point:
      break;
  }
  ImGui::DragFloat3("at, mm", &light.position.x, 0.01f * bounds.radius, 0, 0, "%.1f");
  draw_power(light, "W");
}

}  // namespace

void draw_lights(State& state, const Sphere& bounds) {
  if (!section("Lights")) return;
  auto& lights = state.scene.lights;
  const auto select = [&](std::size_t i) {
    state.light = i;
    state.kind_with_image.reset();
  };
  for (std::size_t i = 0; i < lights.size(); ++i) {
    ImGui::PushID(static_cast<int>(i));
    const std::string text = to_string(lights[i]);
    const std::string name = formatted("%zu  %s", i + 1, text.substr(0, text.find(':')).c_str());
    if (ImGui::RadioButton(name.c_str(), state.light == i)) select(i);
    ImGui::PopID();
  }
  if (state.light < lights.size()) draw_light(state, bounds);
  if (ImGui::Button("add")) {
    lights.push_back(default_lights(state.scene.view).front());
    select(lights.size() - 1);
  }
  ImGui::SameLine();
  if (ImGui::Button("remove") && state.light < lights.size()) {
    lights.erase(lights.begin() + static_cast<std::ptrdiff_t>(state.light));
    select(lights.empty() ? 0 : std::min(state.light, lights.size() - 1));
  }
}

}  // namespace quadgraph
