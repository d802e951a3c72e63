#include "engine/app/environment_section.h"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>

#include "engine/app/panel_widgets.h"
#include "engine/render/light/default_lights.h"
#include "engine/render/light/studio.h"
#include "engine/scene/gestures.h"

namespace quadgraph {
namespace {

bool surrounds(const Light& light) {
  return light.kind == LightKind::environment;
}

auto found_in(std::vector<Light>& lights) {
  return std::find_if(lights.begin(), lights.end(), surrounds);
}

void draw_sky(State& state, const Sphere& bounds) {
  const auto light = found_in(state.scene.lights);
  const bool named = light != state.scene.lights.end() && light->file != studio_name;
  if (!ImGui::IsAnyItemActive()) state.sky_text = named ? light->file : std::string();
  if (ImGui::InputTextWithHint("File##environment", "sky.hdr, .exr, .png, or drop one", &state.sky_text,
                               ImGuiInputTextFlags_EnterReturnsTrue) &&
      !state.sky_text.empty()) {
    put_environment(state.scene, state.sky_text, bounds);
    state.say("");
  }
}

}  // namespace

void put_environment(Scene& scene, const std::string& file, const Sphere& bounds) {
  auto& lights = scene.lights;
  const auto old = found_in(lights);
  Light light = studio_of(scene.view);
  if (file != studio_name) {
    const Light& like = old != lights.end() ? *old
                        : lights.empty()    ? default_lights(scene.view).front()
                                            : lights.front();
    light = surrounds(like) ? like : as_kind(like, LightKind::environment, bounds);
    light.up = scene.view.up == UpAxis::z ? glm::vec3(0, 0, 1) : glm::vec3(0, 1, 0);
    light.file = file;
  }
  if (old != lights.end()) {
    *old = light;
  } else if (lights.size() < most_lights) {
    lights.push_back(light);
  }
}

void draw_environment(State& state, const Sphere& bounds) {
  if (!section("Environment", false)) return;
  auto& lights = state.scene.lights;
  const auto light = found_in(lights);
  const bool none = light == lights.end(), studio = !none && light->file == studio_name;
  if (ImGui::RadioButton("None", none) && !none) {
    lights.erase(light);
    state.light = 0;
    return;
  }
  ImGui::SameLine();
  if (ImGui::RadioButton("Studio", studio) && !studio) put_environment(state.scene, std::string(studio_name), bounds);
  draw_sky(state, bounds);
  const auto now = found_in(lights);
  if (now == lights.end()) return;
  slide("Rotation##environment", now->turn, -180, 180, "%.0f°");
  float stops = std::log2(std::max({now->power.x, now->power.y, now->power.z, 1e-9f}));
  const float before = stops;
  if (slide("Brightness", stops, -24, 8, "%.1f stops")) now->power *= std::exp2(stops - before);
  ImGui::Checkbox("Show environment", &state.scene.render.surroundings);
}

}  // namespace quadgraph
