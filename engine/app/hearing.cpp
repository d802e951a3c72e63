// How the viewer hears while it computes: the device asks it between two pieces of its work, and where the picture that
// is being made is not the one that is wanted any more, that work ends.
#include <utility>

#include "engine/app/modes.h"
#include "engine/app/viewer.h"
#include "engine/scene/layers.h"

namespace quadgraph {
namespace {

constexpr std::chrono::milliseconds answer_pause{30};  // between two frames that answer
// Between two draws of points a solve ends for nothing; half-way the engine loses what it had derived.
constexpr std::chrono::milliseconds patience_half_way{50};

}  // namespace

void Viewer::listen() {
  engine().device().set_check([this] { hear(true); }, hearing_pause);
}

// What the user has done, with what needs no engine already done for it.
std::vector<Event> Viewer::take_events() {
  swapchain_.resize(window_.width(), window_.height());
  const std::vector<Event> events = window_.take_events();
  if (!events.empty()) frames_wanted_ = 3;
  handle(events);
  fulfil_wishes();
  return events;
}

void Viewer::fulfil_wishes() {
  if (state_.full_screen) window_.toggle_full_screen();
  if (state_.undo || state_.redo) {
    history_.note(state_.scene);
    dragging_ = painting_ = false;  // the stroke that is being led may be gone
  }
  if (state_.undo) state_.scene = history_.undo(state_.scene);
  if (state_.redo) state_.scene = history_.redo(state_.scene);
  if (state_.save || state_.save_first) save_scene();
  if (state_.save_film) save_film();
  if (state_.cancel_film) cancel_film();
  follow_film();
  keep_active(state_.scene, state_.layer);
  keep_method(state_);
  leave_or_ask();
  state_.full_screen = state_.save = state_.undo = state_.redo = state_.save_film = state_.cancel_film = false;
}

// Ends, or opens another file, where that is wanted and nothing is lost by it: no change, and no film that is being
// made. What is opened waits for the engine.
void Viewer::leave_or_ask() {
  state_.quit = state_.quit || window_.closing();
  window_.keep_open();
  if (!state_.quit && state_.opening.empty()) return;
  state_.unsaved = replaces_work() && !same_work(state_.scene, saved_);
  state_.asks = !state_.discard && (state_.unsaved || (state_.quit && film_));
  leaving_ = state_.quit && !state_.asks;
}

// A mesh has a window of its own, and a sky is one more light.
bool Viewer::replaces_work() const {
  return state_.quit || state_.opening.extension() == ".qgraph" || state_.opening.extension() == ".json";
}

// half_way: amid a piece of work, which is then lost.
void Viewer::hear(bool half_way) {
  window_.poll(0);
  follow_film();
  const bool wanted = window_.events_wait() || frames_wanted_ > 0;
  if (Clock::now() - answered_ >= answer_pause && wanted) {
    const std::vector<Event> events = take_events();
    build_widgets(events);
    present();
  }
  if (!unwanted()) return unwanted_since_.reset();
  if (!unwanted_since_) unwanted_since_ = Clock::now();
  const bool at_once = leaving_ || (!state_.screenshot && Clock::now() - *unwanted_since_ > patience_half_way);
  if (!half_way || at_once) throw Interrupted();
}

bool Viewer::unwanted() const {
  if (leaving_) return true;
  if (!making_ || !making_->droppable || writing_) return false;
  const bool turns = state_.turntable && !dragging_;
  return state_.screenshot || opens() || turns || wanted_scene() != making_->scene || part() != making_->part;
}

}  // namespace quadgraph
