// The window on the screen and what the user does to it.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "engine/app/events.h"
#include "engine/vk/context.h"

struct GLFWwindow;

namespace quadgraph {

class Window {
 public:
  // Throws InputError where there is no display or it has no Vulkan, and names --headless.
  Window(const std::string& name, int width, int height);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  GLFWwindow* handle() const { return window_; }

  // It is hidden until then.
  void appear();

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

  // What of it the next frame may see.
  std::vector<Event> take_events() { return take_frame(events_); }

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
