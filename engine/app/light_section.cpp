#include "engine/app/light_section.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/app/gestures.h"
#include "engine/app/panel_widgets.h"
#include "engine/render/default_lights.h"

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

}  // namespace

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

}  // namespace quadgraph
