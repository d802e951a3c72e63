// Dear ImGui in our window: input to it, and what it draws onto a frame.
#pragma once

#include <array>
#include <glm/vec2.hpp>
#include <vector>

#include "engine/app/window.h"
#include "engine/vk/swapchain.h"

namespace quadgraph {

class Interface {
 public:
  // One at a time. `scale` as Window::scale.
  Interface(Window& window, vk::Context& context, const vk::Swapchain& swapchain);
  ~Interface();
  Interface(const Interface&) = delete;
  Interface& operator=(const Interface&) = delete;

  // What the user did since the last frame; then the frame's widgets may be made.
  void begin(const std::vector<Event>& events);

  // Whether the pointer is on a widget, and whether keys go to one: then all of them, or letters as text.
  bool has_pointer() const;
  bool has_keys() const;
  bool has_text() const;

  // Whether widgets may change though the user does nothing: cursors blink, buttons that are held down repeat, and what
  // is dimmed fades.
  bool moves() const;

  // Draws the widgets. The image must be in COLOR_ATTACHMENT_OPTIMAL and is left in PRESENT_SRC_KHR.
  void draw(const vk::SwapchainFrame& frame);

  float unit() const { return unit_; }  // window coordinates per pixel of an ordinary display

 private:
  void create_pass(VkFormat format);
  void create_pool();
  void load_fonts(float scale);
  void start_backend();
  void point() const;
  void follow_swapchain();

  Window& window_;
  vk::Context& context_;
  const vk::Swapchain& swapchain_;
  float unit_ = 1;
  static constexpr int buttons = 3;      // of a mouse, that widgets know
  std::array<bool, buttons> down_ = {};  // as the last frame saw them
  glm::vec2 pointer_{0};                 // in window coordinates
  vk::UniqueDescriptorPool pool_;
  vk::UniqueRenderPass pass_;
  std::uint64_t generation_ = 0;  // of the swapchain that the framebuffers are of
  std::vector<vk::UniqueFramebuffer> framebuffers_;
};

}  // namespace quadgraph
