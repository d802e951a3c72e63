#include "engine/app/commands.h"

#include <GLFW/glfw3.h>

#include <algorithm>
#include <array>

#include "engine/app/body_choice.h"
#include "engine/app/modes.h"
#include "engine/optics/material.h"
#include "engine/scene/gestures.h"

namespace quadgraph {
namespace {

using S = State&;
using W = const CommandContext&;

constexpr float key_degrees = 7.5f,
                key_share = 0.04f;  // per key press: an angle, and a share of the body or the picture
constexpr float brighter = 1.25f;
constexpr int control = GLFW_MOD_CONTROL, shift = GLFW_MOD_SHIFT;

void orbit(S s, W w, float right, float up) {
  s.scene.view = orbited(s.scene.view, w.bounds, w.aspect, right, up);
}

void pan(S s, W w, float right, float up) {
  s.scene.view = panned(s.scene.view, w.bounds, w.aspect, right, up);
}

void zoom(S s, W w, float steps) {
  s.scene.view = zoomed(s.scene.view, w.bounds, w.aspect, steps);
}

Light* selected(S s) {
  return s.light < s.scene.lights.size() ? &s.scene.lights[s.light] : nullptr;
}

void turn(S s, W w, float right, float up) {
  if (Light* light = selected(s)) *light = turned(*light, s.scene.view, w.bounds, right, up);
}

void brighten(S s, float factor) {
  if (Light* light = selected(s)) light->power *= factor;
}

void next_light(S s, W) {
  if (!s.scene.lights.empty()) s.light = (s.light + 1) % s.scene.lights.size();
}

void next_material(S s, int by) {
  const auto& names = material_names();
  const auto found = std::find(names.begin(), names.end(), chosen_material(s));
  const auto count = static_cast<int>(names.size());
  const int now = found == names.end() ? (by > 0 ? -1 : 0) : static_cast<int>(found - names.begin());
  choose_material(s, names[static_cast<std::size_t>((now + by + count) % count)]);
}

// The one after `value`, in a circle.
template <typename T, typename All>
void next(T& value, const All& all) {
  const auto found = std::find(all.begin(), all.end(), value);
  value = found == all.end() || found + 1 == all.end() ? all.front() : *(found + 1);
}

void next_method(S s, W) {
  if (s.knife.on || !s.scene.cuts.empty()) return s.say("cuts are shown by shortest-path alone: undo them first", true);
  next(s.scene.solve.method, s.all_methods());
  if (!on_grid(s.scene.solve.method)) s.scene.solve.active_layers = 0;
}

void next_solver(S s, W) {
  next(s.scene.solve.solver, all_values<SolverKind>());
}

void next_source(S s, W) {
  next(s.scene.solve.source, all_values<Source>());
}

void next_model(S s, W) {
  next(s.scene.solve.model, all_values<Model>());
}

void next_error(S s, W) {
  next(s.scene.solve.error, std::array{0.0, 0.1, 0.05, 0.02, 0.01});
}

void next_quantity(S s, W w, int by) {
  std::vector<Quantity> all = all_values<Quantity>();
  std::erase_if(all, [&](Quantity each) {
    const std::optional<Knowledge> knowledge = knowledge_of(each);
    return knowledge && !w.known[static_cast<std::size_t>(*knowledge)];
  });
  const auto count = static_cast<int>(all.size());
  Quantity& quantity = s.scene.render.show.quantity;
  const auto at = static_cast<int>(std::find(all.begin(), all.end(), quantity) - all.begin());
  quantity = all[static_cast<std::size_t>((at + by + count) % count)];
}

void next_axis(S s, W) {
  s.scene.render.show.axis = (s.scene.render.show.axis + 1) % 3;
}

void move_plane(S s, W w, float steps) {
  float& offset = s.scene.render.show.offset;
  offset = std::clamp(offset + steps * key_share * w.bounds.radius, -w.bounds.radius, w.bounds.radius);
}

void next_level(S s, W w) {
  if (w.levels > 0) s.scene.render.show.level = (s.scene.render.show.level + 1) % w.levels;
}

void leave(S s, W) {
  if (!leave_mode(s)) s.quit = true;
}

void reset_view(S s, W) {
  const View old = s.scene.view;
  s.scene.view = first_view(s.front, old.up);
  s.scene.view.vertical_fov = old.vertical_fov;
  if (old.orthographic) s.scene.view.orthographic = 0.0f;
}

constexpr auto table = std::to_array<Command>({
    {"Left", GLFW_KEY_LEFT, 0, 0, "rotate the object left", [](S s, W w) { orbit(s, w, -key_degrees, 0); }},
    {"Right", GLFW_KEY_RIGHT, 0, 0, "rotate the object right", [](S s, W w) { orbit(s, w, key_degrees, 0); }},
    {"Up", GLFW_KEY_UP, 0, 0, "rotate the object up", [](S s, W w) { orbit(s, w, 0, key_degrees); }},
    {"Down", GLFW_KEY_DOWN, 0, 0, "rotate the object down", [](S s, W w) { orbit(s, w, 0, -key_degrees); }},
    {"Shift+Left", GLFW_KEY_LEFT, 0, shift, "pan left", [](S s, W w) { pan(s, w, -key_share, 0); }},
    {"Shift+Right", GLFW_KEY_RIGHT, 0, shift, "pan right", [](S s, W w) { pan(s, w, key_share, 0); }},
    {"Shift+Up", GLFW_KEY_UP, 0, shift, "pan up", [](S s, W w) { pan(s, w, 0, key_share); }},
    {"Shift+Down", GLFW_KEY_DOWN, 0, shift, "pan down", [](S s, W w) { pan(s, w, 0, -key_share); }},
    {"Page Up, =", GLFW_KEY_PAGE_UP, GLFW_KEY_EQUAL, 0, "zoom in", [](S s, W w) { zoom(s, w, 1); }},
    {"Page Down, -", GLFW_KEY_PAGE_DOWN, GLFW_KEY_MINUS, 0, "zoom out", [](S s, W w) { zoom(s, w, -1); }},
    {"Home", GLFW_KEY_HOME, 0, 0, "reset the view: the whole object from its front", reset_view},
    {"L", GLFW_KEY_L, 0, 0, "next light", next_light},
    {"Ctrl+Left", GLFW_KEY_LEFT, 0, control, "rotate the light left", [](S s, W w) { turn(s, w, -key_degrees, 0); }},
    {"Ctrl+Right", GLFW_KEY_RIGHT, 0, control, "rotate the light right", [](S s, W w) { turn(s, w, key_degrees, 0); }},
    {"Ctrl+Up", GLFW_KEY_UP, 0, control, "rotate the light up", [](S s, W w) { turn(s, w, 0, key_degrees); }},
    {"Ctrl+Down", GLFW_KEY_DOWN, 0, control, "rotate the light down", [](S s, W w) { turn(s, w, 0, -key_degrees); }},
    {"]", GLFW_KEY_RIGHT_BRACKET, 0, 0, "light brighter by a quarter", [](S s, W) { brighten(s, brighter); }},
    {"[", GLFW_KEY_LEFT_BRACKET, 0, 0, "light dimmer by a fifth", [](S s, W) { brighten(s, 1 / brighter); }},
    {"M", GLFW_KEY_M, 0, 0, "next material", [](S s, W) { next_material(s, 1); }},
    {"Shift+M", GLFW_KEY_M, 0, shift, "previous material", [](S s, W) { next_material(s, -1); }},
    {"G", GLFW_KEY_G, 0, 0, "next method", next_method},
    {"S", GLFW_KEY_S, 0, 0, "next solver", next_solver},
    {"B", GLFW_KEY_B, 0, 0, "other source: buried, diffuse", next_source},
    {"O", GLFW_KEY_O, 0, 0, "next model", next_model},
    {"E", GLFW_KEY_E, 0, 0, "next error target: none, 10, 5, 2, 1%", next_error},
    {"T", GLFW_KEY_T, 0, 0, "turntable on or off", [](S s, W) { s.turntable = !s.turntable; }},
    {"C", GLFW_KEY_C, 0, 0, "while it is held: before the last change", [](S s, W) { s.compares_by_key = true; }},
    {"P", GLFW_KEY_P, 0, 0, "brush on or off", [](S s, W) { take_brush(s, !s.brush.on); }},
    {"K", GLFW_KEY_K, 0, 0, "knife on or off (by shortest-path, as long as there are cuts)",
     [](S s, W) { take_knife(s, !s.knife.on); }},
    {"V", GLFW_KEY_V, 0, 0, "next view of the inside", [](S s, W w) { next_quantity(s, w, 1); }},
    {"Shift+V", GLFW_KEY_V, 0, shift, "previous view of the inside", [](S s, W w) { next_quantity(s, w, -1); }},
    {"X", GLFW_KEY_X, 0, 0, "axis of the cutting plane: x, y, z", next_axis},
    {".", GLFW_KEY_PERIOD, 0, 0, "move the cutting plane forward", [](S s, W w) { move_plane(s, w, 1); }},
    {",", GLFW_KEY_COMMA, 0, 0, "move the cutting plane back", [](S s, W w) { move_plane(s, w, -1); }},
    {"N", GLFW_KEY_N, 0, 0, "next level, in views of a level", next_level},
    {"Ctrl+Z", GLFW_KEY_Z, 0, control, "undo", [](S s, W) { s.undo = true; }},
    {"Ctrl+Y", GLFW_KEY_Y, 0, control, "redo", [](S s, W) { s.redo = true; }},
    {"Ctrl+S", GLFW_KEY_S, 0, control, "save the scene as JSON", [](S s, W) { s.save = true; }},
    {"Tab", GLFW_KEY_TAB, 0, 0, "keyboard focus to the panel (arrows, Space, Enter); Esc returns it",
     [](S s, W) { s.focus_panel = s.panel = true; }},
    {"F9", GLFW_KEY_F9, 0, 0, "save a film, as the section Film says", [](S s, W) { s.save_film = true; }},
    {"F10", GLFW_KEY_F10, 0, 0, "show or hide the panel", [](S s, W) { s.panel = !s.panel; }},
    {"F11", GLFW_KEY_F11, 0, 0, "toggle full screen", [](S s, W) { s.full_screen = true; }},
    {"F12", GLFW_KEY_F12, 0, 0, "save the image as PNG and EXR", [](S s, W) { s.screenshot = true; }},
    {"F1, H", GLFW_KEY_F1, GLFW_KEY_H, 0, "show or hide these shortcuts", [](S s, W) { s.help = !s.help; }},
    {"Esc", GLFW_KEY_ESCAPE, 0, 0, "leave turntable, brush, knife or shortcuts; else quit", leave},
    {"Q", GLFW_KEY_Q, 0, 0, "quit; asks where something is not saved", [](S s, W) { s.quit = true; }},
});

}  // namespace

std::span<const Command> all_commands() {
  return table;
}

bool run_command(int key, int mods, State& state, const CommandContext& context) {
  constexpr int known = GLFW_MOD_CONTROL | GLFW_MOD_SHIFT | GLFW_MOD_ALT | GLFW_MOD_SUPER;
  for (const Command& command : table) {
    if ((command.key != key && command.other_key != key) || command.mods != (mods & known)) continue;
    command.run(state, context);
    return true;
  }
  return false;
}

}  // namespace quadgraph
