// Move-only ownership of a Vulkan handle, counted by kind (live_objects.h), and the check that turns a failed call into
// DeviceError.
#pragma once

#include <vulkan/vulkan.h>

#include <string_view>
#include <utility>

#include "engine/device/live_objects.h"

namespace quadgraph::vk {

using device::count_gone;
using device::count_made;

// Throws DeviceError("<call>: VK_ERROR_...") unless `result` is VK_SUCCESS.
void check(VkResult result, std::string_view call);

// What a handle is called in LiveObjects.
template <typename Handle>
inline constexpr const char* kind_of = nullptr;
template <>
inline constexpr const char* kind_of<VkBuffer> = "buffer";
template <>
inline constexpr const char* kind_of<VkDeviceMemory> = "device memory";
template <>
inline constexpr const char* kind_of<VkImage> = "image";
template <>
inline constexpr const char* kind_of<VkImageView> = "image view";
template <>
inline constexpr const char* kind_of<VkShaderModule> = "shader module";
template <>
inline constexpr const char* kind_of<VkPipelineLayout> = "pipeline layout";
template <>
inline constexpr const char* kind_of<VkPipeline> = "pipeline";
template <>
inline constexpr const char* kind_of<VkDescriptorPool> = "descriptor pool";
template <>
inline constexpr const char* kind_of<VkCommandPool> = "command pool";
template <>
inline constexpr const char* kind_of<VkFence> = "fence";
template <>
inline constexpr const char* kind_of<VkSemaphore> = "semaphore";
template <>
inline constexpr const char* kind_of<VkSwapchainKHR> = "swapchain";
template <>
inline constexpr const char* kind_of<VkRenderPass> = "render pass";
template <>
inline constexpr const char* kind_of<VkFramebuffer> = "framebuffer";
template <>
inline constexpr const char* kind_of<VkQueryPool> = "query pool";

// A device-level handle destroyed by `Destroy(device, handle, nullptr)`.
template <typename Handle, auto Destroy>
class Unique {
 public:
  Unique() = default;
  Unique(VkDevice device, Handle handle) : device_(device), handle_(handle) {
    static_assert(kind_of<Handle> != nullptr);
    if (handle_ != VK_NULL_HANDLE) count_made(device_, kind_of<Handle>);
  }
  Unique(Unique&& other) noexcept { swap(other); }
  Unique& operator=(Unique&& other) noexcept {
    Unique moved(std::move(other));
    swap(moved);
    return *this;
  }
  ~Unique() {
    if (handle_ == VK_NULL_HANDLE) return;
    Destroy(device_, handle_, nullptr);
    count_gone(device_, kind_of<Handle>);
  }

  Handle get() const { return handle_; }

 private:
  void swap(Unique& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(handle_, other.handle_);
  }

  VkDevice device_ = VK_NULL_HANDLE;
  Handle handle_ = VK_NULL_HANDLE;
};

using UniqueBuffer = Unique<VkBuffer, vkDestroyBuffer>;
using UniqueMemory = Unique<VkDeviceMemory, vkFreeMemory>;
using UniqueImage = Unique<VkImage, vkDestroyImage>;
using UniqueImageView = Unique<VkImageView, vkDestroyImageView>;
using UniqueShaderModule = Unique<VkShaderModule, vkDestroyShaderModule>;
using UniquePipelineLayout = Unique<VkPipelineLayout, vkDestroyPipelineLayout>;
using UniquePipeline = Unique<VkPipeline, vkDestroyPipeline>;
using UniqueDescriptorPool = Unique<VkDescriptorPool, vkDestroyDescriptorPool>;
using UniqueCommandPool = Unique<VkCommandPool, vkDestroyCommandPool>;
using UniqueFence = Unique<VkFence, vkDestroyFence>;
using UniqueSemaphore = Unique<VkSemaphore, vkDestroySemaphore>;
using UniqueSwapchain = Unique<VkSwapchainKHR, vkDestroySwapchainKHR>;
using UniqueRenderPass = Unique<VkRenderPass, vkDestroyRenderPass>;
using UniqueFramebuffer = Unique<VkFramebuffer, vkDestroyFramebuffer>;
using UniqueQueryPool = Unique<VkQueryPool, vkDestroyQueryPool>;

}  // namespace quadgraph::vk
