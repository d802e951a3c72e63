#include "engine/app/window.h"

#define GLFW_INCLUDE_VULKAN
#include <GLFW/glfw3.h>

#include <algorithm>

#include "engine/base/error.h"

namespace quadgraph {
namespace {

std::string glfw_message() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text == nullptr ? "GLFW says nothing more" : text;
}

[[noreturn]] void no_window(const std::string& what) {
  throw InputError(what + " (" + glfw_message() + "): use --headless -o PICTURE.png to render without a window");
}

Window& owner(GLFWwindow* window) {
  return *static_cast<Window*>(glfwGetWindowUserPointer(window));
}

// The monitor that shows most of the window.
GLFWmonitor* monitor_of(GLFWwindow* window) {
  int x = 0, y = 0, width = 0, height = 0, count = 0;
  glfwGetWindowPos(window, &x, &y);
  glfwGetWindowSize(window, &width, &height);
  GLFWmonitor** monitors = glfwGetMonitors(&count);
  GLFWmonitor* best = glfwGetPrimaryMonitor();
  int most = 0;
  for (int i = 0; i < count; ++i) {
    int left = 0, top = 0;
    glfwGetMonitorPos(monitors[i], &left, &top);
    const GLFWvidmode* mode = glfwGetVideoMode(monitors[i]);
    const int wide = std::min(x + width, left + mode->width) - std::max(x, left);
    const int high = std::min(y + height, top + mode->height) - std::max(y, top);
    if (wide <= 0 || high <= 0 || wide * high <= most) continue;
    most = wide * high;
    best = monitors[i];
  }
  return best;
}

}  // namespace

Window::Window(const std::string& name, int width, int height) : name_(name) {
  if (glfwInit() != GLFW_TRUE) no_window("there is no display to open a window on");
  try {
    if (glfwVulkanSupported() != GLFW_TRUE) no_window("this display has no Vulkan");
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
    glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
    window_ = glfwCreateWindow(width, height, title().c_str(), nullptr, nullptr);
    if (window_ == nullptr) no_window("the display opens no window");
  } catch (...) {
    glfwTerminate();
    throw;
  }
  glfwSetWindowSizeLimits(window_, 320, 240, GLFW_DONT_CARE, GLFW_DONT_CARE);
  listen();
}

Window::~Window() {
  glfwDestroyWindow(window_);
  glfwTerminate();
}

void Window::appear() {
  glfwShowWindow(window_);
}

void Window::listen() {
  glfwSetWindowUserPointer(window_, this);
  glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int scancode, int action, int mods) {
    owner(window).events_.push_back(KeyEvent{key, scancode, action, mods});
  });
  glfwSetCharCallback(window_, [](GLFWwindow* window, unsigned int character) {
    owner(window).events_.push_back(TextEvent{character});
  });
  glfwSetMouseButtonCallback(window_, [](GLFWwindow* window, int button, int action, int mods) {
    owner(window).events_.push_back(ButtonEvent{button, action, mods});
  });
  glfwSetCursorPosCallback(window_, [](GLFWwindow* window, double x, double y) {
    Window& self = owner(window);
    const auto ratio = static_cast<double>(self.pixels_per_unit());
    self.events_.push_back(MotionEvent{x * ratio, y * ratio});
  });
  glfwSetDropCallback(window_, [](GLFWwindow* window, int count, const char** files) {
    if (count > 0) owner(window).events_.push_back(DropEvent{files[0]});
  });
  glfwSetScrollCallback(
      window_, [](GLFWwindow* window, double x, double y) { owner(window).events_.push_back(ScrollEvent{x, y}); });
  listen_for_showing();
}

void Window::listen_for_showing() {
  const auto show = [](GLFWwindow* window) { owner(window).events_.push_back(ShowEvent{}); };
  const auto show_changed = [](GLFWwindow* window, int) { owner(window).events_.push_back(ShowEvent{}); };
  glfwSetWindowRefreshCallback(window_, show);
  glfwSetWindowCloseCallback(window_, show);
  glfwSetWindowFocusCallback(window_, show_changed);
  glfwSetWindowIconifyCallback(window_, show_changed);
  glfwSetCursorEnterCallback(window_, show_changed);
  glfwSetFramebufferSizeCallback(window_,
                                 [](GLFWwindow* window, int, int) { owner(window).events_.push_back(ShowEvent{}); });
}

vk::SurfaceSource Window::surface() const {
  vk::SurfaceSource source;
  std::uint32_t count = 0;
  const char** names = glfwGetRequiredInstanceExtensions(&count);
  source.instance_extensions.assign(names, names + count);
  source.create = [window = window_](VkInstance instance) {
    VkSurfaceKHR surface = VK_NULL_HANDLE;
    vk::check(glfwCreateWindowSurface(instance, window, nullptr, &surface), "glfwCreateWindowSurface");
    return surface;
  };
  return source;
}

std::uint32_t Window::width() const {
  int width = 0;
  glfwGetFramebufferSize(window_, &width, nullptr);
  return static_cast<std::uint32_t>(glfwGetWindowAttrib(window_, GLFW_ICONIFIED) == GLFW_TRUE ? 0 : width);
}

std::uint32_t Window::height() const {
  int height = 0;
  glfwGetFramebufferSize(window_, nullptr, &height);
  return static_cast<std::uint32_t>(glfwGetWindowAttrib(window_, GLFW_ICONIFIED) == GLFW_TRUE ? 0 : height);
}

float Window::scale() const {
  float scale = 1;
  glfwGetWindowContentScale(window_, &scale, nullptr);
  return std::clamp(scale, 0.5f, 4.0f);
}

float Window::pixels_per_unit() const {
  int pixels = 0, units = 0;
  glfwGetFramebufferSize(window_, &pixels, nullptr);
  glfwGetWindowSize(window_, &units, nullptr);
  return units > 0 ? static_cast<float>(pixels) / static_cast<float>(units) : 1.0f;
}

void Window::show_busy(bool busy) {
  if (busy == busy_) return;
  busy_ = busy;
  glfwSetWindowTitle(window_, title().c_str());
}

void Window::set_name(const std::string& name) {
  name_ = name;
  glfwSetWindowTitle(window_, title().c_str());
}

std::string Window::title() const {
  return name_ + " - QuadGraph" + (busy_ ? " ..." : "");
}

bool Window::closing() const {
  return glfwWindowShouldClose(window_) == GLFW_TRUE;
}

void Window::keep_open() {
  glfwSetWindowShouldClose(window_, GLFW_FALSE);
}

void Window::toggle_full_screen() {
  full_screen_ = !full_screen_;
  if (!full_screen_) {
    glfwSetWindowMonitor(window_, nullptr, old_x_, old_y_, old_width_, old_height_, GLFW_DONT_CARE);
    return;
  }
  glfwGetWindowPos(window_, &old_x_, &old_y_);
  glfwGetWindowSize(window_, &old_width_, &old_height_);
  GLFWmonitor* monitor = monitor_of(window_);
  if (monitor == nullptr) return;
  const GLFWvidmode* mode = glfwGetVideoMode(monitor);
  glfwSetWindowMonitor(window_, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
}

void Window::poll(double wait_seconds) {
  if (wait_seconds > 0 && events_.empty()) {
    glfwWaitEventsTimeout(wait_seconds);
  } else {
    glfwPollEvents();
  }
}

}  // namespace quadgraph
