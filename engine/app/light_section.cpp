#include "engine/app/light_section.h"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "engine/app/panel_widgets.h"
#include "engine/render/light/default_lights.h"
#include "engine/scene/gestures.h"

namespace quadgraph {
namespace {

// A unit of the table with the signs that the window's font has.
std::string window_text(std::string_view unit) {
  std::string text(unit);
  for (std::size_t at; (at = text.find("^2")) != std::string::npos;) text.replace(at, 2, "²");
  return text;
}

// The label of a field: its name in scene files with a capital.
std::string label_of(const LightField& field) {
  return capitalised(field.name) + "##light";
}

// Brightness and colour of a light whose power spans many decades.
void draw_power(Light& light, const LightField& field) {
  const std::string label = label_of(field);
  float most = std::max({light.power.x, light.power.y, light.power.z, 1e-9f});
  glm::vec3 tint = light.power / most;
  // A text without a conversion: the slider moves along decades and shows the power.
  const std::string told = formatted("%.3g ", static_cast<double>(most)) + window_text(field.unit);
  float decades = std::log10(most);
  if (slide(label.c_str(), decades, -6, field.name == "irradiance" ? 1.0f : 6.0f, told.c_str())) {
    most = std::pow(10.0f, decades);
    light.power = most * tint;
  }
  if (ImGui::ColorEdit3("Colour", &tint.x, ImGuiColorEditFlags_Float | ImGuiColorEditFlags_NoInputs)) {
    light.power = most * tint;
  }
}

// Two sliders for where a direction comes from; whether one was moved.
bool draw_bearing(glm::vec3& direction, UpAxis up) {
  Bearing bearing = bearing_of(-direction, up);
  const bool around = slide("Azimuth##light", bearing.azimuth, -180, 180, "%.0f°");
  const bool above = slide("Elevation##light", bearing.elevation, -89.9f, 89.9f, "%.0f°");
  if (!around && !above) return false;
  direction = -towards(bearing, up);
  return true;
}

bool has_image(LightKind kind) {
  return form_of(kind).image != LightImage::none;
}

// A light that needs an image becomes one when that has been typed.
void draw_kind(State& state, Light& light, const Sphere& bounds) {
  const auto kinds = light_kinds();
  std::vector<std::string_view> names;
  for (const LightForm& form : kinds) names.push_back(form.name);
  const LightForm& shown = form_of(state.kind_with_image.value_or(light.kind));
  auto chosen = static_cast<std::size_t>(&shown - kinds.data());
  if (!choose("Type##light", chosen, names)) return;
  const LightKind kind = kinds[chosen].kind;
  state.kind_with_image.reset();
  if (kind == light.kind) return;
  if (has_image(kind)) {
    state.kind_with_image = kind;
  } else {
    light = as_kind(light, kind, bounds);
  }
}

// A field for the name of an image file. The viewer reports a file that is no image when it shows the scene, and
// restores the light.
void draw_image(State& state, Light& light, const Sphere& bounds) {
  if (!state.kind_with_image && !has_image(light.kind)) return;
  if (!ImGui::IsAnyItemActive()) state.image_text = state.kind_with_image ? std::string() : light.file;
  if (!ImGui::InputTextWithHint("Image##light", "image.png, .exr, .hdr", &state.image_text,
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
  draw_edge("Width##light", light.u);
  draw_edge("Height##light", light.v);
}

// A slider of a number that keeps off ends that are not allowed.
void draw_number(Light& light, const LightField& field) {
  const bool degrees = field.unit == "degrees";
  const auto high = static_cast<float>(field.range.high), low = static_cast<float>(field.range.low);
  slide(label_of(field).c_str(), light.*std::get<float Light::*>(field.member), field.range.above ? low + 1 : low,
        field.range.below ? high - 10 : high, degrees ? "%.0f°" : "%.2f");
}

void draw_field(Light& light, const LightField& field, const Sphere& bounds, UpAxis up) {
  switch (field.form) {
    case FieldForm::direction:
      draw_bearing(light.direction, up);
      break;
    case FieldForm::point:
      ImGui::DragFloat3("Position, mm##light", &light.position.x, 0.01f * bounds.radius, 0, 0, "%.1f");
      break;
    case FieldForm::number:
      draw_number(light, field);
      break;
    case FieldForm::turn:
      slide("Rotation##light", light.turn, -180, 180, "%.0f°");
      break;
    case FieldForm::power:
      draw_power(light, field);
      break;
    case FieldForm::edge:
    case FieldForm::top:
    case FieldForm::axis:
    case FieldForm::file:
      break;
  }
}

void draw_light(State& state, const Sphere& bounds) {
  Light& light = state.scene.lights[state.light];
  const UpAxis up = state.scene.view.up;
  draw_kind(state, light, bounds);
  draw_image(state, light, bounds);
  const LightForm& form = form_of(light.kind);
  if (form.has(FieldForm::edge)) draw_edges(light, bounds, up);
  for (const LightField& field : form.fields) draw_field(light, field, bounds, up);
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
    const std::string name = formatted("%zu  %s", i + 1, std::string(form_of(lights[i].kind).name).c_str());
    if (ImGui::RadioButton(name.c_str(), state.light == i)) select(i);
    ImGui::PopID();
  }
  if (state.light < lights.size()) draw_light(state, bounds);
  if (ImGui::Button("Add##light") && lights.size() < most_lights) {
    lights.push_back(default_lights(state.scene.view).front());
    select(lights.size() - 1);
  }
  ImGui::SameLine();
  if (ImGui::Button("Remove##light") && state.light < lights.size()) {
    lights.erase(lights.begin() + static_cast<std::ptrdiff_t>(state.light));
    select(lights.empty() ? 0 : std::min(state.light, lights.size() - 1));
  }
}

}  // namespace quadgraph
