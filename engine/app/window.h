// The window on the screen and what the user does to it.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "engine/vk/context.h"

struct GLFWwindow;

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

class Window {
 public:
  // Throws InputError where there is no display or it has no Vulkan, and names --headless.
  Window(const std::string& name, int width, int height);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  GLFWwindow* handle() const { return window_; }

  // To present to it. The window must outlive what is made of it.
  vk::SurfaceSource surface() const;

  std::uint32_t width() const;   // pixels; 0 while minimised
  std::uint32_t height() const;  // pixels

  // Pixels per pixel of an ordinary display: 2 where letters must be twice as large.
  float scale() const;

  // Pixels per unit of window coordinates; 1 on X11.
  float pixels_per_unit() const;

  // Adds dots to the title, or takes them away; it has them at first.
  void show_busy(bool busy);
  void set_name(const std::string& name);  // of what is shown, with which the title begins

  bool closing() const;
  void keep_open();  // though it is to be closed
  void toggle_full_screen();

  // Collects what has happened, after waiting for something at most so many seconds.
  void poll(double wait_seconds);

  // What has happened and has not been taken yet, up to what must be left for the next frame because Dear ImGui 1.86
  // looks at keys and pointer once a frame: a key or button that changes again, a button after a motion, and a key
  // after a button, which may go to what that has opened.
  std::vector<Event> take_events();

  // Whether there is anything to take.
  bool events_wait() const { return !events_.empty(); }

 private:
  void listen();
  void listen_for_showing();
  std::string title() const;

  GLFWwindow* window_ = nullptr;
  std::string name_;
  bool busy_ = true;
  std::deque<Event> events_;
  bool full_screen_ = false;
  int old_x_ = 0, old_y_ = 0, old_width_ = 0, old_height_ = 0;  // before full screen
};

}  // namespace quadgraph
