#include "engine/app/events.h"

#include <GLFW/glfw3.h>

namespace quadgraph {
namespace {

// What the events of a frame are so far.
struct Frame {
  bool moved = false, pressed = false, buttoned = false;

  // Adds the next one, unless it must wait.
  bool takes(const Event& next) {
    if (const auto* key = std::get_if<KeyEvent>(&next)) {
      if (key->action == GLFW_REPEAT) return true;
      if (pressed || buttoned) return false;
      pressed = key->action != GLFW_RELEASE;
    } else if (std::holds_alternative<ButtonEvent>(next)) {
      if (pressed || buttoned || moved) return false;
      buttoned = true;
    } else if (std::holds_alternative<MotionEvent>(next)) {
      if (buttoned) return false;
      moved = true;
    }
    return true;
  }
};

}  // namespace

std::vector<Event> take_frame(std::deque<Event>& events) {
  std::vector<Event> taken;
  Frame frame;
  while (!events.empty() && frame.takes(events.front())) {
    taken.push_back(events.front());
    events.pop_front();
  }
  return taken;
}

}  // namespace quadgraph
