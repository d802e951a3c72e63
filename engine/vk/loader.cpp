// The functions of Vulkan that engine/vk, the window and Dear ImGui's backend call, by their names in Vulkan's headers.
// Each calls its namesake in libvulkan.so.1. They are functions, not pointers as volk has them, because the backend,
// which comes compiled, calls functions. The compiler checks the number of parameters, the linker that no function is
// missing.
#include "engine/vk/loader.h"

#include <dlfcn.h>
#include <vulkan/vulkan.h>

#include <cstddef>
#include <string>
#include <tuple>

#include "engine/base/error.h"

namespace quadgraph::vk {
namespace {

constexpr const char* loader_name = "libvulkan.so.1";

void* open_loader() {
  void* opened = dlopen(loader_name, RTLD_NOW | RTLD_LOCAL);
  if (opened != nullptr) return opened;
  throw DeviceError("no Vulkan loader was found (" + std::string(dlerror()) +
                    "), so cpu is the only device: install the loader and the driver of the GPU (Debian: libvulkan1, "
                    "mesa-vulkan-drivers)");
}

void* loader() {
  static void* const opened = open_loader();
  return opened;
}

template <typename Pointer>
Pointer find(const char* name) {
  void* found = dlsym(loader(), name);
  if (found == nullptr) throw DeviceError(std::string(loader_name) + " is older than Vulkan 1.3: it has no " + name);
  return reinterpret_cast<Pointer>(found);
}

template <typename Pointer>
struct Signature;
template <typename R, typename... P>
struct Signature<R(VKAPI_PTR*)(P...)> {
  using Result = R;
  template <std::size_t i>
  using Parameter = std::tuple_element_t<i, std::tuple<P...>>;
};

}  // namespace

void require_loader() {
  loader();
}

}  // namespace quadgraph::vk

using quadgraph::vk::find;
using quadgraph::vk::Signature;

#define TYPE(name, i) Signature<PFN_##name>::Parameter<i>
#define TAKE_1(name) TYPE(name, 0) p0
#define TAKE_2(name) TAKE_1(name), TYPE(name, 1) p1
#define TAKE_3(name) TAKE_2(name), TYPE(name, 2) p2
#define TAKE_4(name) TAKE_3(name), TYPE(name, 3) p3
#define TAKE_5(name) TAKE_4(name), TYPE(name, 4) p4
#define TAKE_6(name) TAKE_5(name), TYPE(name, 5) p5
#define TAKE_7(name) TAKE_6(name), TYPE(name, 6) p6
#define TAKE_8(name) TAKE_7(name), TYPE(name, 7) p7
#define TAKE_9(name) TAKE_8(name), TYPE(name, 8) p8
#define TAKE_10(name) TAKE_9(name), TYPE(name, 9) p9
#define GIVE_1 p0
#define GIVE_2 GIVE_1, p1
#define GIVE_3 GIVE_2, p2
#define GIVE_4 GIVE_3, p3
#define GIVE_5 GIVE_4, p4
#define GIVE_6 GIVE_5, p5
#define GIVE_7 GIVE_6, p6
#define GIVE_8 GIVE_7, p7
#define GIVE_9 GIVE_8, p8
#define GIVE_10 GIVE_9, p9

// Hidden, so that the Python module offers none of them to others.
#define FORWARD(count, name)                                                                                   \
  [[gnu::visibility("hidden")]] VKAPI_ATTR Signature<PFN_##name>::Result VKAPI_CALL name(TAKE_##count(name)) { \
    static const auto found = find<PFN_##name>(#name);                                                         \
    return found(GIVE_##count);                                                                                \
  }

FORWARD(6, vkAcquireNextImageKHR)
FORWARD(3, vkAllocateCommandBuffers)
FORWARD(3, vkAllocateDescriptorSets)
FORWARD(4, vkAllocateMemory)
FORWARD(2, vkBeginCommandBuffer)
FORWARD(4, vkBindBufferMemory)
FORWARD(4, vkBindImageMemory)
FORWARD(3, vkCmdBeginRenderPass)
FORWARD(2, vkCmdBeginRendering)
FORWARD(8, vkCmdBindDescriptorSets)
FORWARD(4, vkCmdBindIndexBuffer)
FORWARD(3, vkCmdBindPipeline)
FORWARD(5, vkCmdBindVertexBuffers)
FORWARD(6, vkCmdClearColorImage)
FORWARD(5, vkCmdCopyBuffer)
FORWARD(6, vkCmdCopyBufferToImage)
FORWARD(6, vkCmdCopyImageToBuffer)
FORWARD(4, vkCmdDispatch)
FORWARD(3, vkCmdDispatchIndirect)
FORWARD(5, vkCmdDraw)
FORWARD(6, vkCmdDrawIndexed)
FORWARD(1, vkCmdEndRenderPass)
FORWARD(1, vkCmdEndRendering)
FORWARD(5, vkCmdFillBuffer)
FORWARD(10, vkCmdPipelineBarrier)
FORWARD(2, vkCmdPipelineBarrier2)
FORWARD(6, vkCmdPushConstants)
FORWARD(4, vkCmdSetScissor)
FORWARD(4, vkCmdSetViewport)
FORWARD(5, vkCmdUpdateBuffer)
FORWARD(4, vkCmdWriteTimestamp2)
FORWARD(4, vkCreateBuffer)
FORWARD(4, vkCreateCommandPool)
FORWARD(6, vkCreateComputePipelines)
FORWARD(4, vkCreateDescriptorPool)
FORWARD(4, vkCreateDescriptorSetLayout)
FORWARD(4, vkCreateDevice)
FORWARD(4, vkCreateFence)
FORWARD(4, vkCreateFramebuffer)
FORWARD(6, vkCreateGraphicsPipelines)
FORWARD(4, vkCreateImage)
FORWARD(4, vkCreateImageView)
FORWARD(3, vkCreateInstance)
FORWARD(4, vkCreatePipelineLayout)
FORWARD(4, vkCreateQueryPool)
FORWARD(4, vkCreateRenderPass)
FORWARD(4, vkCreateSampler)
FORWARD(4, vkCreateSemaphore)
FORWARD(4, vkCreateShaderModule)
FORWARD(4, vkCreateSwapchainKHR)
FORWARD(3, vkDestroyBuffer)
FORWARD(3, vkDestroyCommandPool)
FORWARD(3, vkDestroyDescriptorPool)
FORWARD(3, vkDestroyDescriptorSetLayout)
FORWARD(2, vkDestroyDevice)
FORWARD(3, vkDestroyFence)
FORWARD(3, vkDestroyFramebuffer)
FORWARD(3, vkDestroyImage)
FORWARD(3, vkDestroyImageView)
FORWARD(2, vkDestroyInstance)
FORWARD(3, vkDestroyPipeline)
FORWARD(3, vkDestroyPipelineLayout)
FORWARD(3, vkDestroyQueryPool)
FORWARD(3, vkDestroyRenderPass)
FORWARD(3, vkDestroySampler)
FORWARD(3, vkDestroySemaphore)
FORWARD(3, vkDestroyShaderModule)
FORWARD(3, vkDestroySurfaceKHR)
FORWARD(3, vkDestroySwapchainKHR)
FORWARD(1, vkDeviceWaitIdle)
FORWARD(1, vkEndCommandBuffer)
FORWARD(4, vkEnumerateDeviceExtensionProperties)
FORWARD(3, vkEnumerateInstanceExtensionProperties)
FORWARD(2, vkEnumerateInstanceLayerProperties)
FORWARD(3, vkEnumeratePhysicalDevices)
FORWARD(3, vkFlushMappedMemoryRanges)
FORWARD(4, vkFreeCommandBuffers)
FORWARD(3, vkFreeMemory)
FORWARD(2, vkGetBufferDeviceAddress)
FORWARD(3, vkGetBufferMemoryRequirements)
FORWARD(2, vkGetDeviceProcAddr)
FORWARD(4, vkGetDeviceQueue)
FORWARD(3, vkGetImageMemoryRequirements)
FORWARD(2, vkGetInstanceProcAddr)
FORWARD(2, vkGetPhysicalDeviceFeatures2)
FORWARD(3, vkGetPhysicalDeviceFormatProperties)
FORWARD(2, vkGetPhysicalDeviceMemoryProperties)
FORWARD(2, vkGetPhysicalDeviceProperties)
FORWARD(2, vkGetPhysicalDeviceProperties2)
FORWARD(3, vkGetPhysicalDeviceQueueFamilyProperties)
FORWARD(3, vkGetPhysicalDeviceSurfaceCapabilitiesKHR)
FORWARD(4, vkGetPhysicalDeviceSurfaceFormatsKHR)
FORWARD(4, vkGetPhysicalDeviceSurfacePresentModesKHR)
FORWARD(4, vkGetPhysicalDeviceSurfaceSupportKHR)
FORWARD(8, vkGetQueryPoolResults)
FORWARD(4, vkGetSwapchainImagesKHR)
FORWARD(6, vkMapMemory)
FORWARD(2, vkQueuePresentKHR)
FORWARD(4, vkQueueSubmit2)
FORWARD(3, vkResetCommandPool)
FORWARD(3, vkResetFences)
FORWARD(2, vkGetFenceStatus)
FORWARD(4, vkResetQueryPool)
FORWARD(2, vkUnmapMemory)
FORWARD(5, vkUpdateDescriptorSets)
FORWARD(5, vkWaitForFences)
