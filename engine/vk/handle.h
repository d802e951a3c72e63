// Move-only ownership of a Vulkan handle, and the check that turns a failed call into VulkanError.
#pragma once

#include <vulkan/vulkan.h>

#include <string_view>
#include <utility>

namespace quadgraph::vk {

// Throws VulkanError("<call>: VK_ERROR_...") unless `result` is VK_SUCCESS.
void check(VkResult result, std::string_view call);

// A device-level handle destroyed by `Destroy(device, handle, nullptr)`.
template <typename Handle, auto Destroy>
class Unique {
 public:
  Unique() = default;
  Unique(VkDevice device, Handle handle) : device_(device), handle_(handle) {}
  Unique(Unique&& other) noexcept { swap(other); }
  Unique& operator=(Unique&& other) noexcept {
    Unique moved(std::move(other));
    swap(moved);
    return *this;
  }
  ~Unique() {
    if (handle_ != VK_NULL_HANDLE) Destroy(device_, handle_, nullptr);
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
using UniqueBufferView = Unique<VkBufferView, vkDestroyBufferView>;
using UniqueDescriptorSetLayout = Unique<VkDescriptorSetLayout, vkDestroyDescriptorSetLayout>;
using UniqueDescriptorPool = Unique<VkDescriptorPool, vkDestroyDescriptorPool>;
using UniqueCommandPool = Unique<VkCommandPool, vkDestroyCommandPool>;
using UniqueFence = Unique<VkFence, vkDestroyFence>;
using UniqueSemaphore = Unique<VkSemaphore, vkDestroySemaphore>;
using UniqueSwapchain = Unique<VkSwapchainKHR, vkDestroySwapchainKHR>;
using UniqueRenderPass = Unique<VkRenderPass, vkDestroyRenderPass>;
using UniqueFramebuffer = Unique<VkFramebuffer, vkDestroyFramebuffer>;
using UniqueQueryPool = Unique<VkQueryPool, vkDestroyQueryPool>;

}  // namespace quadgraph::vk
