// What the viewer does with keys and pointer.
#include <GLFW/glfw3.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <optional>
#include <utility>

#include "engine/app/body_choice.h"
#include "engine/app/viewer.h"
#include "engine/base/error.h"
#include "engine/scene/gestures.h"

namespace quadgraph {
namespace {

constexpr float still = 4;  // pixels of an ordinary display, that a click may go
constexpr std::chrono::milliseconds outline_time{1500};
constexpr float degrees_per_height = 180.0f;  // of a drag over the height of the picture

}  // namespace

void Viewer::handle(const std::vector<Event>& events) {
  for (const Event& event : events) {
    if (const auto* key = std::get_if<KeyEvent>(&event)) {
      handle_key(*key);
    } else if (const auto* motion = std::get_if<MotionEvent>(&event)) {
      handle_motion(*motion);
    } else if (const auto* button = std::get_if<ButtonEvent>(&event)) {
      begin_or_end_drag(*button);
    } else if (const auto* drop = std::get_if<DropEvent>(&event)) {
      state_.opening = drop->file;
    } else if (const auto* scroll = std::get_if<ScrollEvent>(&event); scroll != nullptr && !interface_.has_pointer()) {
      const CommandContext context = command_context();
      state_.scene.view = zoomed(state_.scene.view, context.bounds, context.aspect, static_cast<float>(scroll->y));
    }
  }
}

void Viewer::begin_or_end_drag(const ButtonEvent& event) {
  dragging_ = event.action == GLFW_PRESS && !interface_.has_pointer();
  drag_button_ = event.button;
  drag_mods_ = event.mods;
  if (dragging_) state_.focus_picture = true;
  const bool plain = event.button == GLFW_MOUSE_BUTTON_LEFT && event.mods == 0;
  begin_or_end_click(plain);
  const auto touch = dragging_ && plain && state_.brush.on ? pointed_at() : std::nullopt;
  painting_ = touch.has_value();
  if (touch && !touch_down(*touch)) dragging_ = painting_ = false;
  Knife& knife = state_.knife;
  if (!dragging_ && knife.cuts()) {
    const CommandContext context = command_context();
    state_.cut = state_.scene.cuts.size();
    state_.scene.cuts.push_back(cut_along(state_.scene.view, context.bounds, context.aspect, *knife.from, *knife.to));
  }
  knife.from = dragging_ && plain && knife.on ? std::optional(pointer()) : std::nullopt;
  knife.to.reset();
}

// What goes down and up again in one place chooses the body there.
void Viewer::begin_or_end_click(bool plain) {
  const bool free = !state_.brush.on && !state_.knife.on && !interface_.has_pointer();
  if (dragging_) {
    clicking_ = plain && free ? std::optional(glm::dvec2(pointer_x_, pointer_y_)) : std::nullopt;
    return;
  }
  if (!std::exchange(clicking_, std::nullopt) || !free || state_.bodies.size() < 2) return;
  const auto found = picker_.pick(seen_from(), pointer());
  choose_body(state_, found ? std::optional(picker_.body_of(*found)) : std::nullopt);
  outlined_.clear();  // shown anew, also where it was chosen before
}

// Around the body that has been chosen, for a while.
std::vector<Segment> Viewer::chosen_outline() {
  if (outlined_ != state_.body) outlined_until_ = Clock::now() + outline_time;
  outlined_ = state_.body;
  const auto found = std::ranges::find(state_.bodies, state_.body);
  outlines_ = found != state_.bodies.end() && Clock::now() <= outlined_until_;
  if (!outlines_) return {};
  return picker_.outline(static_cast<std::uint32_t>(found - state_.bodies.begin()), seen_from(),
                         command_context().aspect);
}

// Whether the drag goes on with what begins here.
bool Viewer::touch_down(const Touch& touch) {
  try {
    const bool goes_on = state_.brush.touch(state_.scene, state_.layer, touch);
    if (goes_on && state_.refused) state_.say("");
    return goes_on;
  } catch (const InputError& error) {
    state_.say(error.what(), true);
    return false;
  }
}

void Viewer::handle_key(const KeyEvent& event) {
  const bool plain = event.mods == 0 && !interface_.has_text();
  if (event.key == GLFW_KEY_C) state_.compares_by_key = plain && event.action != GLFW_RELEASE && !state_.asks;
  if (event.action == GLFW_RELEASE) return;
  if (state_.asks) return answer_question(event.key);
  if (interface_.has_text()) return;
  if (interface_.has_keys()) {
    // The panel has the keys that move in it.
    constexpr int theirs[] = {GLFW_KEY_LEFT, GLFW_KEY_RIGHT, GLFW_KEY_UP,    GLFW_KEY_DOWN,
                              GLFW_KEY_TAB,  GLFW_KEY_SPACE, GLFW_KEY_ENTER, GLFW_KEY_HOME};
    if (event.key == GLFW_KEY_ESCAPE) state_.focus_picture = true;
    if (event.key == GLFW_KEY_ESCAPE || std::find(std::begin(theirs), std::end(theirs), event.key) != std::end(theirs))
      return;
  }
  run_command(event.key, event.mods, state_, command_context());
}

// Of whether to save before it ends.
void Viewer::answer_question(int key) {
  if (state_.unsaved && (key == GLFW_KEY_S || key == GLFW_KEY_ENTER)) state_.save_first = true;
  if (key == GLFW_KEY_D) state_.discard = true;
  if (key == GLFW_KEY_ESCAPE) state_.keep();
}

void Viewer::handle_motion(const MotionEvent& event) {
  const CommandContext context = command_context();
  const auto height = static_cast<float>(std::max(part().height, 1u));
  const float right = static_cast<float>(event.x - pointer_x_) / height;
  const float up = static_cast<float>(pointer_y_ - event.y) / height;
  pointer_x_ = event.x;
  pointer_y_ = event.y;
  if (!dragging_) return;
  if (clicking_ && glm::distance(*clicking_, glm::dvec2(pointer_x_, pointer_y_)) > double{still * window_.scale()}) {
    clicking_.reset();
  }
  if (painting_) {
    if (const auto touch = pointed_at()) state_.brush.go_on(state_.scene, state_.layer, *touch);
    return;
  }
  if (state_.knife.from) {
    state_.knife.to = pointer();
    return;
  }
  View& view = state_.scene.view;
  if (drag_button_ != GLFW_MOUSE_BUTTON_LEFT) {
    view = panned(view, context.bounds, context.aspect, right, up);
  } else if ((drag_mods_ & (GLFW_MOD_CONTROL | GLFW_MOD_SHIFT)) == 0) {
    view = orbited(view, context.bounds, context.aspect, degrees_per_height * right, degrees_per_height * up);
  } else if (state_.light < state_.scene.lights.size()) {
    Light& light = state_.scene.lights[state_.light];
    light = turned(light, view, context.bounds, degrees_per_height * right, degrees_per_height * up);
  }
}

// In clip coordinates.
glm::vec2 Viewer::pointer() const {
  const Part now = part();
  const glm::vec2 share((pointer_x_ - now.left) / std::max(now.width, 1u), pointer_y_ / std::max(now.height, 1u));
  return {2 * share.x - 1, 1 - 2 * share.y};
}

Camera Viewer::seen_from() const {
  const CommandContext context = command_context();
  return place_camera(state_.scene.view, context.bounds, context.aspect);
}

// The brush's edges on the body around the pointer.
std::vector<Ring> Viewer::brush_rings() const {
  if (!state_.brush.on || interface_.has_pointer()) return {};
  return picker_.rings(seen_from(), pointer(), state_.brush);
}

// Where the pointer meets the body.
std::optional<Touch> Viewer::pointed_at() const {
  return picker_.touch(seen_from(), pointer(), state_.brush.mirror);
}

}  // namespace quadgraph
