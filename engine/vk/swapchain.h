// The images that a window shows, one after the other.
//
// One frame at a time: `begin` waits for the last one. Who writes what a frame reads calls `wait` before.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/device/memory.h"
#include "engine/vk/context.h"
#include "engine/vk/handle.h"
#include "engine/vk/memory.h"

namespace quadgraph::vk {

// A frame being recorded: commands that draw onto an image whose contents are undefined and whose layout is
// TRANSFER_DST_OPTIMAL.
struct SwapchainFrame {
  VkCommandBuffer commands;
  VkImage image;
  VkImageView view;
  std::uint32_t number;  // which image of the swapchain
};

class Swapchain {
 public:
  // Presents to the context's surface. The window is `width` x `height` pixels where the surface does not say so
  // itself. Throws DeviceError where the surface has no 8-bit format that copies can write.
  Swapchain(Context& context, std::uint32_t width, std::uint32_t height);
  ~Swapchain();
  Swapchain(const Swapchain&) = delete;
  Swapchain& operator=(const Swapchain&) = delete;

  // The window has now that many pixels, 0 while it is minimised: `width` and `height` follow at once. Throws
  // DeviceError.
  void resize(std::uint32_t width, std::uint32_t height);

  std::uint32_t width() const { return width_; }    // pixels; 0 while there is nothing to show on
  std::uint32_t height() const { return height_; }  // pixels
  VkFormat format() const { return format_.format; }
  bool blue_first() const { return format_.format == VK_FORMAT_B8G8R8A8_UNORM; }
  std::uint32_t image_count() const { return static_cast<std::uint32_t>(images_.size()); }
  VkImageView view(std::uint32_t number) const { return views_[number].get(); }

  // Grows by one with every new set of images: what was made of the views is then stale.
  std::uint64_t generation() const { return generation_; }

  // Whether the next frame has new images.
  bool stale() const { return stale_; }

  // Begins a frame; empty if there is none to show now: the window is minimised, or has just changed.
  std::optional<SwapchainFrame> begin();

  // Shows it. The image must be in PRESENT_SRC_KHR.
  void present(const SwapchainFrame& frame);

  // Waits until nothing of a frame is running any more.
  void wait();

 private:
  void choose_format();
  void create();
  void create_images();
  void create_commands();
  UniqueSemaphore semaphore();
  void submit(const SwapchainFrame& frame);

  Context& context_;
  std::uint32_t wanted_width_, wanted_height_;
  std::uint32_t width_ = 0, height_ = 0;
  bool stale_ = true;
  std::uint64_t generation_ = 0;
  VkSurfaceFormatKHR format_{};
  UniqueSwapchain swapchain_;
  std::vector<VkImage> images_;
  std::vector<UniqueImageView> views_;
  std::vector<UniqueSemaphore> drawn_;  // per image
  UniqueSemaphore acquired_;
  UniqueFence fence_;  // of the last frame
  UniqueCommandPool pool_;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
};

// Moves a swapchain's image from one layout to another, with a full barrier.
void transition(VkCommandBuffer commands, VkImage image, VkImageLayout from, VkImageLayout to);

// Writes `width` x `height` pixels of 4 bytes, tightly packed, into the frame's image from (x, y) on. All within it.
void copy_pixels(const SwapchainFrame& frame, const device::Buffer& pixels, std::uint32_t x, std::uint32_t y,
                 std::uint32_t width, std::uint32_t height);

}  // namespace quadgraph::vk
