// What the user does to the window, and how much of it goes into one frame.
#pragma once

#include <deque>
#include <filesystem>
#include <variant>
#include <vector>

namespace quadgraph {

// In the order in which they happened; numbers as GLFW has them.
struct KeyEvent {
  int key, scancode, action, mods;
};
struct TextEvent {
  unsigned int character;
};
struct ButtonEvent {
  int button, action, mods;
};
struct MotionEvent {
  double x, y;  // pixels from the upper left corner
};
struct ScrollEvent {
  double x, y;  // steps
};
struct DropEvent {
  std::filesystem::path file;  // the first of those that were dropped
};
struct ShowEvent {};  // the window is seen anew, has another size or focus, or is to close: it must be drawn
using Event = std::variant<KeyEvent, TextEvent, ButtonEvent, MotionEvent, ScrollEvent, DropEvent, ShowEvent>;

// Takes from the front what one frame may see. Dear ImGui 1.86 looks once a frame at which keys and buttons are down
// and where the pointer is, and at text before keys: so a frame has one press of a key, with its text, or one change of
// a button, whose pointer has been there since the frame before, and nothing is let go in it after that. Otherwise a
// busy window, which sees Ctrl+A when both keys have been let go, would lose it. What a held key repeats does not wait.
std::vector<Event> take_frame(std::deque<Event>& events);

}  // namespace quadgraph
